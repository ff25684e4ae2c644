// An example of a game: ODE's world is the game's own, Lodestone simulates what falls in it. SDL2 and
// OpenGL 2.1; needs no files.
//   lodestone_game [--frames N] [--screenshot FILE.bmp] [--budget-ms MS]
// With --frames the camera flies by itself, balls are thrown, and after N frames a line of figures is
// printed.
#include <SDL.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/game/game_world.h"
#include "tools/game/overlay.h"
#include "tools/game/picture.h"

namespace game {
namespace {

using namespace lodestone;

constexpr int kDone = 0, kUsage = 2, kBadInput = 3, kDiverged = 4;  // exit codes, as the command line's
constexpr double kFrame = 1.0 / 60.0;                               // s

struct Arguments {
  int frames = 0;  // 0: until the player ends it
  std::string screenshot;
  double budget_ms = 8.0;
};

constexpr const char* kUsageText =
    "usage: lodestone_game [--frames N] [--screenshot FILE.bmp] [--budget-ms MS]\n"
    "--frames N runs N frames with a camera that flies by itself and prints a line of figures; --screenshot "
    "saves the last of them.\n"
    "Exit codes: 0 done, 2 usage, 3 bad input or no display, 4 the simulation diverged.\n";

/// A number above zero, the whole text; none: the text is no such number.
std::optional<double> positive_number(const char* text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  return *text && !*end && std::isfinite(value) && value > 0.0 ? std::optional(value) : std::nullopt;
}

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    const std::optional<double> number = positive_number(value);
    if (option == "--screenshot" && *value)
      arguments.screenshot = value;
    else if (option == "--frames" && number && *number < 1e6 && *number == std::floor(*number))
      arguments.frames = int(*number);
    else if (option == "--budget-ms" && number)
      arguments.budget_ms = *number;
    else
      return std::nullopt;
  }
  if (!arguments.screenshot.empty() && arguments.frames == 0) return std::nullopt;
  return arguments;
}

bool asks_for_help(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [](const std::string& argument) { return argument == "--help" || argument == "-h"; });
}

/// An InputError with SDL's own words.
[[noreturn]] void throw_sdl_error(const std::string& found, std::string_view expected) {
  throw_input_error("lodestone_game", found + " (" + SDL_GetError() + ")", expected);
}

/// Where there is no display, SDL falls back on drivers that show nothing to anybody, unless it was asked for
/// one of them by name.
bool shows_nothing(const std::string& driver) {
  return !SDL_getenv("SDL_VIDEODRIVER") && (driver == "offscreen" || driver == "dummy" || driver == "evdev");
}

struct Window {
  SDL_Window* window = nullptr;
  SDL_GLContext context = nullptr;
  int width = 1280, height = 720;

  explicit Window(bool wait_for_screen) {
    if (SDL_Init(SDL_INIT_VIDEO) != 0) throw_sdl_error("no display", "one");
    if (shows_nothing(SDL_GetCurrentVideoDriver())) throw_input_error("lodestone_game", "no display", "one");
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MAJOR_VERSION, 2);
    SDL_GL_SetAttribute(SDL_GL_CONTEXT_MINOR_VERSION, 1);
    SDL_GL_SetAttribute(SDL_GL_DEPTH_SIZE, 24);
    window = SDL_CreateWindow("Lodestone", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, width, height,
                              SDL_WINDOW_OPENGL | SDL_WINDOW_RESIZABLE);
    context = window ? SDL_GL_CreateContext(window) : nullptr;
    if (!context) throw_sdl_error("no window with OpenGL 2.1", "one");
    SDL_GL_SetSwapInterval(wait_for_screen ? 1 : 0);
  }
  ~Window() {
    if (context) SDL_GL_DeleteContext(context);
    if (window) SDL_DestroyWindow(window);
    SDL_Quit();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  double aspect() const { return double(width) / height; }
};

/// Of what was drawn last. Throws InputError where the file cannot be written.
void save_picture(const Window& window, const std::string& file) {
  const std::size_t row = 4 * std::size_t(window.width);
  std::vector<unsigned char> pixels(row * std::size_t(window.height)), turned(pixels.size());
  glReadPixels(0, 0, window.width, window.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  for (int y = 0; y < window.height; ++y)
    std::memcpy(&turned[row * std::size_t(y)], &pixels[row * std::size_t(window.height - 1 - y)],
                row);  // OpenGL begins at the bottom
  SDL_Surface* surface = SDL_CreateRGBSurfaceWithFormatFrom(turned.data(), window.width, window.height, 32,
                                                            int(row), SDL_PIXELFORMAT_RGBA32);
  SDL_Surface* opaque = surface ? SDL_ConvertSurfaceFormat(surface, SDL_PIXELFORMAT_BGR24, 0) : nullptr;
  const bool saved = opaque && SDL_SaveBMP(opaque, file.c_str()) == 0;
  SDL_FreeSurface(opaque);
  SDL_FreeSurface(surface);
  if (!saved) throw_sdl_error(file + ", which cannot be written", "a file that can");
}

class Game {
 public:
  explicit Game(const Arguments& arguments) : arguments_(arguments), window_(arguments.frames == 0) {
    PolicyChoice policy = world_.policy();
    policy.budget_ms = arguments.budget_ms;
    world_.set_policy(policy);
  }

  void play();
  void play_script();
  int print_figures();

 private:
  void step();
  void show();
  void handle_events();
  void press(SDL_Keycode key);
  void set_policy(PolicyKind kind);
  void fly(double seconds);

  Arguments arguments_;
  Window window_;
  GameWorld world_;
  Picture picture_;
  Camera camera_ = scripted_camera(0.0);
  std::vector<double> step_ms_;
  bool running_ = true, paused_ = false, hulls_ = false;
};

void Game::step() { step_ms_.push_back(world_.step(camera_, window_.height, window_.aspect())); }

void Game::show() {
  picture_.draw(world_, camera_, window_.width, window_.height, hulls_);
  const PolicyChoice& policy = world_.policy();
  draw_overlay({.report = world_.manager().report(),
                .policy = policy.text(),
                .budget_ms = policy.has_budget() ? policy.budget_ms : 0.0,
                .spent_ms = step_ms_.empty() ? 0.0 : step_ms_.back(),
                .history_ms = step_ms_,
                .paused = paused_},
               window_.width, window_.height);
}

void Game::set_policy(PolicyKind kind) {
  PolicyChoice policy = world_.policy();
  policy.kind = kind;
  world_.set_policy(policy);
}

void Game::press(SDL_Keycode key) {
  PolicyChoice policy = world_.policy();
  switch (key) {
    case SDLK_ESCAPE:
      running_ = false;
      break;
    case SDLK_SPACE:
      world_.throw_ball(camera_);
      break;
    case SDLK_r:
      world_.drop_ragdoll(camera_.position + 3.0 * camera_.direction());
      break;
    case SDLK_p:
      paused_ = !paused_;
      break;
    case SDLK_h:
      hulls_ = !hulls_;
      break;
    case SDLK_1:
      set_policy(PolicyKind::distance);
      break;
    case SDLK_2:
      set_policy(PolicyKind::budget);
      break;
    case SDLK_3:
      set_policy(PolicyKind::error_budget);
      break;
    case SDLK_4:
      set_policy(PolicyKind::projected_size);
      break;
    case SDLK_PLUS:
    case SDLK_EQUALS:
    case SDLK_KP_PLUS:
      policy.turn(true), world_.set_policy(policy);
      break;
    case SDLK_MINUS:
    case SDLK_KP_MINUS:
      policy.turn(false), world_.set_policy(policy);
      break;
    default:
      break;
  }
}

void Game::handle_events() {
  for (SDL_Event event; SDL_PollEvent(&event);) {
    if (event.type == SDL_QUIT) running_ = false;
    if (event.type == SDL_KEYDOWN && !event.key.repeat) press(event.key.keysym.sym);
    if (event.type == SDL_MOUSEBUTTONDOWN) world_.throw_ball(camera_);
    if (event.type == SDL_MOUSEMOTION)
      camera_.yaw -= 0.003 * event.motion.xrel, camera_.pitch -= 0.003 * event.motion.yrel;
    if (event.type == SDL_WINDOWEVENT && event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED)
      SDL_GL_GetDrawableSize(window_.window, &window_.width, &window_.height);
  }
}

void Game::fly(double seconds) {
  const Uint8* keys = SDL_GetKeyboardState(nullptr);
  const auto pressed = [&](SDL_Scancode one, SDL_Scancode other) {
    return double(keys[one]) - double(keys[other]);
  };
  const double speed = keys[SDL_SCANCODE_LSHIFT] ? 15.0 : 5.0, turn = 1.5;  // m/s, rad/s
  camera_.position += speed * seconds *
                      (pressed(SDL_SCANCODE_W, SDL_SCANCODE_S) * camera_.direction() +
                       pressed(SDL_SCANCODE_D, SDL_SCANCODE_A) * camera_.right() +
                       pressed(SDL_SCANCODE_E, SDL_SCANCODE_Q) * Vec3::UnitZ());
  camera_.yaw += turn * seconds * pressed(SDL_SCANCODE_LEFT, SDL_SCANCODE_RIGHT);
  camera_.pitch =
      std::clamp(camera_.pitch + turn * seconds * pressed(SDL_SCANCODE_UP, SDL_SCANCODE_DOWN), -1.5, 1.5);
  const double limit = 0.5 * Terrain::kSide,
               ground = std::abs(camera_.position.x()) < limit && std::abs(camera_.position.y()) < limit
                            ? Terrain::height(camera_.position.x(), camera_.position.y())
                            : -20.0;
  camera_.position.z() = std::max(camera_.position.z(), ground + 0.3);
}

// The simulation goes in steps of 1/60 s whatever the screen does; at most two a picture.
void Game::play() {
  SDL_SetRelativeMouseMode(SDL_TRUE);
  double waiting = 0.0;
  for (Uint64 last = SDL_GetPerformanceCounter(); running_;) {
    const Uint64 now = SDL_GetPerformanceCounter();
    const double passed = double(now - last) / double(SDL_GetPerformanceFrequency());
    last = now;
    handle_events();
    fly(std::min(passed, 0.1));
    waiting = paused_ ? 0.0 : std::min(waiting + passed, 2.0 * kFrame);
    for (; waiting >= kFrame; waiting -= kFrame) step();
    show();
    SDL_GL_SwapWindow(window_.window);
  }
}

void Game::play_script() {
  for (int frame = 0; frame < arguments_.frames; ++frame) {
    handle_events();
    if (!running_) return;
    camera_ = scripted_camera(frame * kFrame);
    if (frame % 30 == 15) world_.throw_ball(camera_);
    step();
    show();
    if (frame + 1 == arguments_.frames && !arguments_.screenshot.empty())
      save_picture(window_, arguments_.screenshot);
    SDL_GL_SwapWindow(window_.window);
  }
}

int Game::print_figures() {
  if (step_ms_.empty()) return kDone;
  std::vector<double> sorted = step_ms_;
  std::ranges::sort(sorted);
  const auto quantile = [&](double share) {
    return sorted[std::min(std::size_t(share * double(sorted.size())), sorted.size() - 1)];
  };
  const StepReport& report = world_.manager().report();
  std::printf("frames %zu full %d support %d tables %d asleep %d p50_ms %.2f p99_ms %.2f\n", step_ms_.size(),
              report.full, report.support, report.tables, report.asleep, quantile(0.5), quantile(0.99));
  return report.counters.states_recovered > 0 ? kDiverged : kDone;
}

int run(const Arguments& arguments) {
  Game game(arguments);
  arguments.frames ? game.play_script() : game.play();
  return game.print_figures();
}

}  // namespace
}  // namespace game

int main(int argc, char** argv) {
  if (game::asks_for_help(argc, argv)) {
    std::fputs(game::kUsageText, stdout);
    return game::kDone;
  }
  const auto arguments = game::parse(argc, argv);
  if (!arguments) {
    std::fputs(game::kUsageText, stderr);
    return game::kUsage;
  }
  dInitODE2(0);
  int exit_code = game::kBadInput;
  try {
    exit_code = game::run(*arguments);
  } catch (const lodestone::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
  } catch (const lodestone::SimulationError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    exit_code = game::kDiverged;
  }
  dCloseODE();
  return exit_code;
}
