// The one exception a user is meant to read: a single line that names file, line or channel, and the remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace fathom {

/// Bad input from outside (file, message, argument). what() is one line for the operator; programs print it and exit 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fathom
