#include "processes/fathom/origin.hpp"

#include <algorithm>
#include <cctype>

#include "common/base/file_hash.hpp"
#include "common/wire/streams.hpp"
#include "processes/fathom/inputs.hpp"

namespace fathom::tool {
namespace {

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view{"_-./:=,+@%"}.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string{"'\\''"} : std::string(1, c);
  return text + "'";
}

OriginFile hashed(std::string_view role, const std::string& path) {
  const FileHash hash = hash_of_file(path);
  OriginFile file;
  file.role = role;
  file.path = path;
  file.sha256 = hash.sha256;
  file.bytes = hash.bytes;
  return file;
}

}  // namespace

void add_file(ResultOrigin& origin, std::string_view role, const std::string& path) {
  if (!path.empty()) origin.files.push_back(hashed(role, path));
}

void add_recording(ResultOrigin& origin, std::string_view role, const std::string& path,
                   std::span<const Recording> stretches) {
  std::optional<Utime> begin, end;
  for (const Recording& recording : stretches) {
    wire::visit_streams(recording, [&](const char*, const auto& stream) {
      for (const auto& sample : stream) {
        begin = std::min(begin.value_or(sample.utime), sample.utime);
        end = std::max(end.value_or(sample.utime), sample.utime);
      }
    });
  }
  for (const Source& source : sources_of({path})) {
    for (const std::string& each : source.files) {
      OriginFile file = hashed(role, each);
      file.run = stretches.front().name;
      file.begin = begin;
      file.end = end;
      origin.files.push_back(std::move(file));
    }
  }
}

void add_words(ResultOrigin& origin, std::string_view option, std::span<const std::string> words) {
  if (words.empty()) return;
  if (!option.empty()) origin.command += " ";
  origin.command += option;
  for (const std::string& word : words) origin.command += " " + quoted(word);
}

void add_words(ResultOrigin& origin, std::string_view option, const std::string& word) {
  if (!word.empty()) add_words(origin, option, std::span{&word, 1});
}

}  // namespace fathom::tool
