#include "common/recordings/content.hpp"

#include <utility>

#include "common/base/error.hpp"
#include "common/recordings/joined_parts.hpp"

namespace fathom::recordings {

Content read_files(const Files& files, std::set<std::string> columns, Collector::Take take) {
  Content content{.files = files, .topics = {}, .damage = {}};
  content.topics = std::make_unique<Collector>(files.format->clock, std::move(columns), take);
  JoinedParts joined{*content.topics};
  for (const std::string& path : files.paths) {
    Sink* sink = content.topics.get();
    if (files.paths.size() > 1) {
      joined.next_part();
      sink = &joined;
    }
    if (files.read) {
      files.read(path, *sink, content.damage);
    } else {
      files.format->read(path, *sink, content.damage);
    }
  }
  content.topics->finish();
  return content;
}

std::vector<std::string> remarks(const Content& content) {
  std::vector<std::string> notes;
  for (const std::string& sentence : content.damage.sentences()) notes.push_back("not read: " + sentence);
  if (const std::uint64_t refused = content.topics->refused(); refused > 0) {
    std::string topics;
    for (const TopicAccount& each : content.topics->topics()) {
      if (each.refused > 0)
        topics += (topics.empty() ? "" : ", ") + each.topic.name + " " + std::to_string(each.refused);
    }
    notes.push_back("left out: " + std::to_string(refused) + " messages whose time fits nothing around them (" +
                    topics + ")");
  }
  return notes;
}

void require_messages(const Content& content) {
  if (content.topics->messages() > 0) return;
  std::string why;
  for (const std::string& remark : remarks(content)) why += "; " + remark;
  throw InputError(content.path() + ": holds no message that can be read" + why);
}

}  // namespace fathom::recordings
