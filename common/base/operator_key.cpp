#include "common/base/operator_key.hpp"

#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "common/base/config.hpp"
#include "common/base/error.hpp"

namespace fathom {
namespace {

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// A key that can be searched for, from a log with its signatures, is none: all of its 256 bits must be drawn.
Key key_in(const Config& section) {
  Key key{};
  const std::string word = section.text("key");
  bool good = word.size() == 2 * key.size();
  for (std::size_t i = 0; good && i < key.size(); ++i) {
    const int high = digit(word[2 * i]), low = digit(word[2 * i + 1]);
    good = high >= 0 && low >= 0;
    key[i] = static_cast<std::uint8_t>(16 * high + low);
  }
  if (!good) section.fail("key", std::string{"the key is not 64 hex digits; make one with: "} + kMakeKey);
  return key;
}

}  // namespace

OperatorKeys keys_from(const Key& key) {
  return {.order = derived(key, "fathom OPERATOR"),
          .command = derived(key, "fathom WRENCH_COMMAND"),
          .answer = derived(key, "fathom ANSWER")};
}

OperatorKeys operator_keys(const std::string& path) {
  const Config section = Config::load(path).section("operator");
  if (section.has("token")) {
    section.fail("token", std::string{"a word is no longer enough, since orders are signed; make a key with: "} +
                              kMakeKey + ", and copy the file to the vehicle");
  }
  OperatorKeys keys = keys_from(key_in(section));
  if (section.has("known_to_all")) keys.known_to_all = section.either("known_to_all", "yes", "no");
  section.finish();
  struct stat about {};
  if (stat(path.c_str(), &about) != 0) throw InputError(path + ": " + std::strerror(errno));
  if (!keys.known_to_all && (about.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    throw InputError(path + ": others than its owner may read or change this key; chmod 600 " + path);
  }
  return keys;
}

}  // namespace fathom
