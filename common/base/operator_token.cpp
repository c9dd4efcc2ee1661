#include "common/base/operator_token.hpp"

#include "common/base/config.hpp"

namespace fathom {

std::string operator_token(const std::string& path) {
  constexpr std::size_t kShortest = 8;
  const Config section = Config::load(path).section("operator");
  std::string token = section.text("token");
  if (token.size() < kShortest)
    section.fail("token", "the token is shorter than eight letters; make one with: openssl rand -hex 16");
  section.finish();
  return token;
}

}  // namespace fathom
