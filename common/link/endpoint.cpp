#include "common/link/endpoint.hpp"

#include <charconv>
#include <optional>
#include <string_view>

#include "common/base/error.hpp"

namespace fathom::link {
namespace {

template <class T>
std::optional<T> read_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

Endpoint Endpoint::parse(const std::string& text, const std::string& where) {
  const auto complain = [&](const std::string& what) { return InputError(where + ": '" + text + "': " + what); };
  Endpoint endpoint{.text = text};
  const auto question = text.find('?');
  const auto scheme = text.find("://");
  if (scheme == std::string::npos) {
    throw complain("write serial:///dev/NAME?baud=N, tcp://HOST:PORT, udp://HOST:PORT or file://PATH");
  }
  const std::string kind = text.substr(0, scheme);
  const std::string place = text.substr(scheme + 3, question == std::string::npos ? question : question - scheme - 3);
  const auto option = [&](const std::string& wanted, const std::string& name, const std::string& value) {
    if (name != wanted) return false;
    if (value.empty()) throw complain("'" + name + "' has no value");
    return true;
  };
  if (kind == "serial") {
    endpoint.kind = Kind::kSerial;
    endpoint.path = place;
  } else if (kind == "file") {
    endpoint.kind = Kind::kFile;
    endpoint.path = place;
  } else if (kind == "tcp" || kind == "udp") {
    endpoint.kind = kind == "tcp" ? Kind::kTcp : Kind::kUdp;
    const auto colon = place.rfind(':');
    const auto port = colon == std::string::npos ? std::nullopt : read_number<int>(place.substr(colon + 1));
    if (!port || *port < 1 || *port > 65535) throw complain("has no port; write " + kind + "://HOST:PORT");
    endpoint.port = *port;
    endpoint.host = place.substr(0, colon);
    if (endpoint.host.empty() && kind == "tcp") throw complain("names no host; write tcp://HOST:PORT");
  } else {
    throw complain("unknown kind of link; known: serial, tcp, udp, file");
  }
  if (place.empty()) throw complain("names no device; write " + kind + "://...");
  for (std::string rest = question == std::string::npos ? "" : text.substr(question + 1); !rest.empty();) {
    const std::string one = rest.substr(0, rest.find('&'));
    rest = one.size() < rest.size() ? rest.substr(one.size() + 1) : "";
    const std::string name = one.substr(0, one.find('='));
    const std::string value = name.size() < one.size() ? one.substr(name.size() + 1) : "";
    if (endpoint.kind == Kind::kSerial && option("baud", name, value)) {
      endpoint.baud = read_number<int>(value).value_or(0);
      if (endpoint.baud <= 0) throw complain("'baud' is a number of bits per second, as 115200");
    } else if (endpoint.kind == Kind::kFile && option("rate", name, value)) {
      endpoint.rate = read_number<double>(value).value_or(0.0);
      if (!(endpoint.rate > 0.0)) throw complain("'rate' is a number of bytes per second, as 11520");
    } else if (endpoint.kind == Kind::kFile && option("speed", name, value)) {
      endpoint.speed = read_number<double>(value).value_or(-1.0);
      if (!(endpoint.speed >= 0.0)) throw complain("'speed' is 1 for as it was, 0 for as fast as possible");
    } else if (endpoint.kind == Kind::kFile && option("start", name, value)) {
      endpoint.start = read_number<Utime>(value).value_or(-1);
      if (endpoint.start < 0) throw complain("'start' is microseconds since 1970");
    } else {
      throw complain("unknown option '" + name + "'");
    }
  }
  if (endpoint.kind == Kind::kSerial && endpoint.baud == 0) throw complain("has no baud rate; add ?baud=115200");
  return endpoint;
}

}  // namespace fathom::link
