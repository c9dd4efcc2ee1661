// A sink that remembers all that a reader says.
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/recordings/formats.hpp"
#include "test/support/scratch.hpp"

namespace fathom::test {

struct HeardTopic {
  recordings::Topic topic;
  std::vector<recordings::Stamp> stamps;
  std::vector<std::vector<double>> rows;
  std::string words;

  /// Column of a field; absent numbers are NaN.
  [[nodiscard]] std::vector<double> column(const std::string& field) const {
    for (std::size_t i = 0; i < topic.fields.size(); ++i) {
      if (topic.fields[i].name != field) continue;
      std::vector<double> values;
      for (const auto& row : rows) values.push_back(i < row.size() ? row[i] : std::numeric_limits<double>::quiet_NaN());
      return values;
    }
    throw std::runtime_error("no field " + field + " in " + topic.name);
  }
};

struct Heard final : recordings::Sink {
  std::vector<HeardTopic> topics;

  bool topic(std::size_t number, const recordings::Topic& topic) override {
    if (topics.size() <= number) topics.resize(number + 1);
    topics[number].topic = topic;
    return true;
  }
  void further_field(std::size_t topic, const recordings::Field& field) override {
    topics.at(topic).topic.fields.push_back(field);
  }
  void message(std::size_t topic, recordings::Stamp stamp, std::span<const double> values) override {
    topics.at(topic).stamps.push_back(stamp);
    topics.at(topic).rows.emplace_back(values.begin(), values.end());
  }
  void text(std::size_t topic, std::string_view, std::string_view words) override {
    if (topics.at(topic).words.empty()) topics.at(topic).words = words;
  }

  [[nodiscard]] const HeardTopic& of(const std::string& name) const {
    for (const HeardTopic& each : topics) {
      if (each.topic.name == name) return each;
    }
    throw std::runtime_error("no topic " + name);
  }
  [[nodiscard]] bool has(const std::string& name) const {
    for (const HeardTopic& each : topics) {
      if (each.topic.name == name) return true;
    }
    return false;
  }
};

struct HeardFile {
  Heard heard;
  recordings::Damage damage;
  std::string format;
};

inline HeardFile hear_file(const std::string& path) {
  HeardFile file;
  const recordings::Format* format = recordings::format_of(path);
  if (format == nullptr) throw std::runtime_error(path + ": not recognised");
  file.format = format->name;
  format->read(path, file.heard, file.damage);
  return file;
}

/// Bytes as a file, by their content alone.
inline HeardFile hear(const std::string& bytes) {
  const Scratch scratch;
  write_bytes(scratch.path("recording"), bytes);
  return hear_file(scratch.path("recording"));
}

}  // namespace fathom::test
