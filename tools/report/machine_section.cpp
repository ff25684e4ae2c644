#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <thread>

#include "build_commit.h"
#include "tools/report/machine.h"
#include "tools/report/sections.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  utsname system{};
  uname(&system);
  return system.machine;
}

std::string system_name() {
  std::ifstream in("/etc/os-release");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("PRETTY_NAME=\"")) return line.substr(13, line.size() - 14);
  return "unknown";
}

std::string compiler_name() {
#ifdef __clang__
  return fmt::format("Clang {}", __clang_version__);
#else
  return fmt::format("GCC {}", __VERSION__);
#endif
}

}  // namespace

std::string describe_machine() {
  return fmt::format("{}, {} cores, {}, {}, ODE {}", processor_name(), std::thread::hardware_concurrency(),
                     system_name(), compiler_name(), LODESTONE_ODE_VERSION);
}

std::string program_commit() { return LODESTONE_COMMIT; }

std::string today() { return fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))); }

ordered_json machine_section() {
  return {{"processor", processor_name()},
          {"cores", std::thread::hardware_concurrency()},
          {"system", system_name()},
          {"compiler", compiler_name()},
          {"ode", LODESTONE_ODE_VERSION},
          {"commit", program_commit()},
          {"date", today()}};
}

}  // namespace lodestone
