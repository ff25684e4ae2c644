// The world drawn with OpenGL 2.1: hills, walls and bodies, these coloured by rung.
#pragma once

#include <SDL_opengl.h>

#include <optional>
#include <unordered_map>
#include <vector>

#include "tools/game/game_world.h"

namespace game {

/// Needs a current OpenGL context all its life.
class Picture {
 public:
  static constexpr double kVerticalFov = 1.0471975511965976;  ///< rad, as Viewpoint's default

  Picture();
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  /// With `hulls` bodies are as the manager draws them: as their rung has them, and with contacts.
  void draw(GameWorld& world, const Camera& camera, int width, int height, bool hulls);

 private:
  GLuint list_of(const lodestone::Shape& shape);
  void read_poses(const GameWorld& world, const lodestone::Manager& manager);
  void draw_bodies(const GameWorld& world, const lodestone::Manager& manager);
  void draw_shadows(const GameWorld& world, const lodestone::Manager& manager);

  GLuint terrain_list_ = 0;
  std::unordered_map<const lodestone::Shape*, GLuint> shape_lists_;
  std::vector<float> positions_, orientations_;
  std::vector<lodestone::Ray> rays_;
  std::vector<std::optional<lodestone::QueryHit>> grounds_;
};

}  // namespace game
