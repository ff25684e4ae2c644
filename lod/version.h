// The version of Lodestone that a program is compiled against. CMake takes the package's version from here.
#pragma once

#define LODESTONE_VERSION_MAJOR 0
#define LODESTONE_VERSION_MINOR 1
#define LODESTONE_VERSION_PATCH 0
#define LODESTONE_VERSION_STRING "0.1.0"
/// The version as one number, for #if: 10000 · major + 100 · minor + patch.
#define LODESTONE_VERSION \
  (LODESTONE_VERSION_MAJOR * 10000 + LODESTONE_VERSION_MINOR * 100 + LODESTONE_VERSION_PATCH)
