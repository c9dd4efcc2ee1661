// Runs a program of the build as a user would: words in, text and exit code out.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace fathom::test {

struct Ran {
  int code{};
  std::string text;  ///< stdout and stderr
  [[nodiscard]] bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
  [[nodiscard]] long lines() const {
    long count = 0;
    for (const char c : text) count += c == '\n' ? 1 : 0;
    return count;
  }
};

inline Ran shell(const std::string& command) {
  FILE* pipe = popen(("{ " + command + "\n} </dev/null 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("no shell");
  Ran ran;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    ran.text.append(buffer.data(), n);
  const int status = pclose(pipe);
  ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ran;
}

#ifndef FATHOM_EMULATOR  // what runs programs that were built for another processor
#define FATHOM_EMULATOR ""
#endif

/// A program of this build, quoted.
inline std::string program(const std::string& name) {
  const std::string emulator = FATHOM_EMULATOR;
  return emulator + (emulator.empty() ? "'" : " '") + FATHOM_BINARY_DIR + "/bin/" + name + "'";
}
/// A file of the repository, quoted.
inline std::string file(const std::string& path) { return std::string{"'"} + FATHOM_SOURCE_DIR + "/" + path + "'"; }

}  // namespace fathom::test
