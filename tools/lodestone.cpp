// The command line: `lodestone run | sign | inspect | compare …`.
#include "tools/commands.h"

int main(int argc, char** argv) { return int(lodestone::run_lodestone(argc, argv)); }
