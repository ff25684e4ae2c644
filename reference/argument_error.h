// An argument of a command, or a setting of a call, that is out of range: no file's fault.
#pragma once

#include "reference/error.h"

namespace lodestone {

/// An InputError for which the caller alone can be blamed; the program ends with the exit code for wrong
/// usage.
class ArgumentError : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace lodestone
