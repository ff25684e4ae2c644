// The child is a copy of this process (fork), which may have more threads: between fork and _exit it
// allocates, which glibc allows, and takes no other lock that a thread may have held; should it hang all the
// same, its alarm ends it.
#include "reference/mesh/mesh_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "reference/error.h"
#include "reference/sanitizers.h"

namespace lodestone {
namespace {

/// What comes through the pipe: this, then the vertices and faces, or the message.
struct ChildReply {
  enum Kind : std::uint64_t { mesh = 1, error = 2, out_of_memory = 3 };
  std::uint64_t kind = 0, vertices = 0, faces = 0, message_bytes = 0;
};

bool write_all(int pipe, const void* data, std::size_t bytes) {
  for (const char* at = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t written = write(pipe, at, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    at += written;
    bytes -= std::size_t(written);
  }
  return true;
}

/// Whether all of them came before the pipe's end.
bool read_all(int pipe, void* data, std::size_t bytes) {
  for (char* at = static_cast<char*>(data); bytes > 0;) {
    const ssize_t got = read(pipe, at, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    bytes -= std::size_t(got);
  }
  return true;
}

/// Address space of this process; 0 where it cannot be told.
std::uintmax_t address_space() {
  std::uintmax_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * std::uintmax_t(sysconf(_SC_PAGESIZE));
}

void set_limit(int what, std::uintmax_t most, std::uintmax_t grace = 0) {
  rlimit limit{};
  if (getrlimit(__rlimit_resource_t(what), &limit) != 0) return;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, most);
  limit.rlim_max = std::min<rlim_t>(limit.rlim_max, most + grace);
  setrlimit(__rlimit_resource_t(what), &limit);
}

void limit_this_process(const ChildLimits& limits, std::uintmax_t address_space_before) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGINT, SIGTERM, SIGALRM, SIGXCPU, SIGSEGV, SIGABRT, SIGBUS, SIGFPE})
    std::signal(signal, SIG_DFL);
  // Sanitizers map terabytes for themselves.
  if (address_space_before > 0 && !LODESTONE_ADDRESS_SANITIZER && !LODESTONE_THREAD_SANITIZER)
    set_limit(RLIMIT_AS, address_space_before + limits.memory_bytes);
  set_limit(RLIMIT_CPU, limits.processor_s, 1);  // then SIGXCPU, a second later SIGKILL
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_FSIZE, 0);
  alarm(limits.wall_s);
  if (const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC); nothing >= 0)
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, stream);
}

[[noreturn]] void be_child(int pipe, const std::function<Mesh()>& read) {
  ChildReply reply;
  Mesh mesh;
  std::string message;
  try {
    mesh = read();
    reply = {.kind = ChildReply::mesh, .vertices = mesh.vertices.size(), .faces = mesh.faces.size()};
  } catch (const std::bad_alloc&) {
    reply = {.kind = ChildReply::out_of_memory};
  } catch (const std::exception& error) {
    message = error.what();
    reply = {.kind = ChildReply::error, .message_bytes = message.size()};
  }
  const bool sent = write_all(pipe, &reply, sizeof reply) &&
                    write_all(pipe, mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3)) &&
                    write_all(pipe, mesh.faces.data(), mesh.faces.size() * sizeof(mesh.faces[0])) &&
                    write_all(pipe, message.data(), message.size());
  _exit(sent ? 0 : 1);
}

/// Ends the child, if it is still there, and closes the pipe, whatever happens here.
class Child {
 public:
  Child(const std::function<Mesh()>& read, const ChildLimits& limits) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw InputError(
          fmt::format("found no pipe ({}), expected one to a child process", std::strerror(errno)));
    const std::uintmax_t before = address_space();
    process_ = fork();
    if (process_ == 0) {
      limit_this_process(limits, before);
      be_child(ends[1], read);
    }
    const int fault = errno;
    close(ends[1]);
    pipe_ = ends[0];
    if (process_ > 0) return;
    close(pipe_);
    throw InputError(fmt::format("found no child process ({}), expected one", std::strerror(fault)));
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    close(pipe_);
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    wait();
  }

  int pipe() const { return pipe_; }

  /// How it ended; called once.
  int wait() {
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = 0;
    return status;
  }

 private:
  int pipe_ = -1;
  pid_t process_ = 0;
};

[[noreturn]] void explain_death(const std::string& name, int status, const ChildLimits& limits) {
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  std::string found = fmt::format("its reader ended with {}", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
  if (signal != 0) found = fmt::format("its reader killed by signal {} ({})", signal, strsignal(signal));
  if (signal == SIGXCPU) found = fmt::format("over {} s of reading", limits.processor_s);
  if (signal == SIGALRM) found = fmt::format("over {} s of waiting for its reader", limits.wall_s);
  throw InputError(fmt::format("{}: found {}, expected a mesh that can be read", name, found));
}

/// The child may have been taken over by the file: nothing that it sends is trusted.
void require_sound(const Mesh& mesh, const std::string& name) {
  const auto is_index = [&](int i) { return i >= 0 && i < int(mesh.vertices.size()); };
  for (const auto& [a, b, c] : mesh.faces)
    if (!is_index(a) || !is_index(b) || !is_index(c))
      throw InputError(name + ": found an index out of range, expected a mesh");
  for (const Vec3& vertex : mesh.vertices)
    if (!vertex.allFinite()) throw InputError(name + ": found a vertex that is not finite, expected a mesh");
}

}  // namespace

Mesh read_mesh_in_child(const std::string& name, const std::function<Mesh()>& read, int max_faces,
                        const ChildLimits& limits) {
  Child child(read, limits);
  ChildReply reply;
  if (!read_all(child.pipe(), &reply, sizeof reply)) explain_death(name, child.wait(), limits);
  if (reply.kind == ChildReply::out_of_memory)
    throw InputError(fmt::format("{}: found a file that takes over {} MB to read, expected less", name,
                                 limits.memory_bytes >> 20));
  constexpr std::uint64_t kLongestMessage = 1 << 16;
  if (reply.kind == ChildReply::error && reply.message_bytes <= kLongestMessage) {
    std::string message(reply.message_bytes, '\0');
    if (!read_all(child.pipe(), message.data(), message.size())) explain_death(name, child.wait(), limits);
    throw InputError(message);
  }
  const std::uint64_t most = std::uint64_t(max_faces);
  if (reply.kind != ChildReply::mesh || reply.faces > most || reply.vertices > 3 * most)
    throw InputError(name + ": found nonsense from its reader, expected a mesh");
  Mesh mesh;
  mesh.vertices.resize(reply.vertices);
  mesh.faces.resize(reply.faces);
  if (!read_all(child.pipe(), mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3)) ||
      !read_all(child.pipe(), mesh.faces.data(), mesh.faces.size() * sizeof(mesh.faces[0])))
    explain_death(name, child.wait(), limits);
  require_sound(mesh, name);
  return mesh;
}

}  // namespace lodestone
