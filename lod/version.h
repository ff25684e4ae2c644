// The version of Lodestone that a program was compiled against. CMake takes the package's version from here.
#pragma once

#define LODESTONE_VERSION_MAJOR 0
#define LODESTONE_VERSION_MINOR 1
#define LODESTONE_VERSION_PATCH 0
#define LODESTONE_VERSION_STRING "0.1.0"
/// One number that rises with the version, for #if.
#define LODESTONE_VERSION \
  (LODESTONE_VERSION_MAJOR * 10000 + LODESTONE_VERSION_MINOR * 100 + LODESTONE_VERSION_PATCH)
