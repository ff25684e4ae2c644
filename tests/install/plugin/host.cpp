// Loads the module named by its argument and calls it.
#include <dlfcn.h>

#include "../check.h"

int main(int, char** arguments) {
  void* module = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
  if (!module) std::printf("%s\n", dlerror());
  check::that(module, "a module with the engine in it is loaded");
  if (module) {
    const auto height = reinterpret_cast<double (*)(double)>(dlsym(module, "height_after_a_fall"));
    check::within(height(0.5), 10 - 0.5 * 9.81 * 0.25 - 0.05, 10 - 0.5 * 9.81 * 0.25 + 0.05,
                  "height after half a second of fall, m");
  }
  return check::result();
}
