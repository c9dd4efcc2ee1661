// What the files of a recording hold, topic by topic, and what of them could not be read.
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "common/recordings/collector.hpp"
#include "common/recordings/damage.hpp"
#include "common/recordings/formats.hpp"

namespace fathom::recordings {

/// A recording of a known format: one file, or the parts of a split one in their order.
struct Files {
  std::vector<std::string> paths;
  const Format* format{};
  /// In the place of the format's own, where reading needs more than the file.
  std::function<void(const std::string& path, Sink& sink, Damage& damage)> read{};
};

/// What was read of it.
struct Content {
  Files files;
  std::unique_ptr<Collector> topics;
  Damage damage;

  [[nodiscard]] const std::string& path() const { return files.paths.front(); }
};

/// Reads the files once. `columns` are kept; InputError where a file has no beginning.
[[nodiscard]] Content read_files(const Files& files, std::set<std::string> columns, Collector::Take take);

/// What is to be said of what was read: damage, refused stamps.
[[nodiscard]] std::vector<std::string> remarks(const Content& content);

/// InputError where not one message could be read: with what was seen instead.
void require_messages(const Content& content);

}  // namespace fathom::recordings
