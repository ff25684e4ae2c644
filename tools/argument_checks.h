// What holds for every argument that is a number, whichever command it is of.
#pragma once

namespace CLI {
class App;
}

namespace lodestone {

/// To be called once all commands are there. From then on each of their options that takes a number refuses
/// what is none (not a number, infinite, beyond its type's range, a sign where there can be none), before its
/// own checks, which not-a-number passes; and every refusal of an option's value reads `found …, expected …`.
void check_numbers(CLI::App& program);

}  // namespace lodestone
