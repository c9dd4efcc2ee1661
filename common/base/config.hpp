// The one door to YAML: every key must be known, every number carries its unit, and every complaint names file and
// line.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

namespace fathom {

/// A section of a configuration file. Reading a key marks it; finish() refuses keys nobody read.
class Config {
 public:
  /// Reads a file; InputError "file:line: what" when it cannot be parsed.
  [[nodiscard]] static Config load(const std::string& path);
  /// Reads text; `name` stands for the file in messages.
  [[nodiscard]] static Config parse(const std::string& text, const std::string& name);

  [[nodiscard]] bool has(const std::string& key) const;
  [[nodiscard]] Config section(const std::string& key) const;
  [[nodiscard]] std::vector<Config> list(const std::string& key) const;  ///< a sequence of sections
  [[nodiscard]] std::vector<std::string> keys() const;                   ///< of this section, in file order
  [[nodiscard]] std::string text(const std::string& key) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const;  ///< a sequence of words
  [[nodiscard]] bool flag(const std::string& key) const;
  /// True for the word `yes`, false for `no`; every other word is refused.
  [[nodiscard]] bool either(const std::string& key, const std::string& yes, const std::string& no) const;
  [[nodiscard]] int integer(const std::string& key) const;
  /// "11.5 kg" read as `unit` "kg": value in `unit`. A missing or different unit is refused. `unit` "" = dimensionless.
  [[nodiscard]] double quantity(const std::string& key, const std::string& unit) const;
  /// The same, greater than zero.
  [[nodiscard]] double positive(const std::string& key, const std::string& unit) const;
  /// The same, zero or greater.
  [[nodiscard]] double not_negative(const std::string& key, const std::string& unit) const;
  [[nodiscard]] std::vector<double> quantities(
      const std::string& key, const std::string& unit) const;  ///< "[1, 2, 3] m": see docs/configuration.md
  [[nodiscard]] Eigen::Vector3d vector3(const std::string& key, const std::string& unit) const;

  /// InputError for the first key, in this section or below, that nobody has read.
  void finish() const;
  /// "file:line" of this section (or of `key`), for messages of the caller.
  [[nodiscard]] std::string where(const std::string& key = "") const;
  /// Throws InputError "file:line: what" at `key` of this section; a misspelt key of the section is named instead.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;
  /// True when `key` holds a section (a map), not a value or a list.
  [[nodiscard]] bool is_section(const std::string& key) const;

 private:
  struct Node;
  explicit Config(std::shared_ptr<Node> node) : node_(std::move(node)) {}
  std::shared_ptr<Node> node_;
};

}  // namespace fathom
