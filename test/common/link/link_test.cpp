// Lines: their names, raw recordings, and a link over a pseudo-terminal and a socket that comes back by itself.
#include "common/link/link.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "common/base/error.hpp"
#include "common/link/raw_log.hpp"
#include "common/link/server.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using namespace fathom::link;
using test::Scratch;

namespace {

struct Heard {
  std::string bytes;
  std::vector<std::string> changes;  ///< "up", or why not
  Link::Received received() {
    return [this](std::span<const std::uint8_t> piece, Utime) {
      bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
    };
  }
  Link::Changed changed() {
    return [this](bool up, const std::string& why) { changes.push_back(up ? "up" : why); };
  }
};

template <class Condition>
bool until(Link& link, Condition&& condition,
           double seconds = 20.0) {  // a busy machine; who comes at once waits for nothing
  const double end = wall_seconds() + seconds;
  while (!condition()) {
    if (wall_seconds() > end) return false;
    link.wait({}, 10);
  }
  return true;
}

}  // namespace

TEST_CASE("endpoints: every kind, and what is wrong with others in one line") {
  const Endpoint serial = Endpoint::parse("serial:///dev/ttyUSB0?baud=57600", "here");
  CHECK(serial.path == "/dev/ttyUSB0");
  CHECK(serial.baud == 57600);
  CHECK(Endpoint::parse("tcp://192.168.2.95:16171", "here").port == 16171);
  CHECK(Endpoint::parse("udp://:7000", "here").host.empty());
  CHECK(Endpoint::parse("file://a.raw?speed=1&rate=960", "here").rate == 960.0);
  for (const char* bad : {"", "ttyUSB0", "serial:///dev/ttyUSB0", "serial://?baud=9600", "serial:///dev/x?baud=fast",
                          "tcp://host", "tcp://:80", "tcp://host:99999", "http://x:1", "file://", "file://x?loop=1"}) {
    CAPTURE(bad);
    const std::string said = test::complaint_of<InputError>([&] { (void)Endpoint::parse(bad, "a.yaml:3"); });
    CHECK(said.starts_with("a.yaml:3: '"));
    CHECK(said.find('\n') == std::string::npos);
  }
}

TEST_CASE("raw recordings: pieces and times come back, bare bytes get times from a rate") {
  const Scratch scratch;
  const std::string path = scratch.path("dive.raw");
  {
    RawWriter writer{path};
    writer.write(1'700'000'000'000'123, std::vector<std::uint8_t>{1, 2, 3});
    writer.write(1'700'000'000'010'000, std::vector<std::uint8_t>{0xFF});
  }
  RawReader reader{path, 0, 1.0};
  const auto first = reader.next();
  REQUIRE(first);
  CHECK(first->utime == 1'700'000'000'000'123);
  CHECK(first->bytes == std::vector<std::uint8_t>{1, 2, 3});
  CHECK(reader.next()->bytes.size() == 1);
  CHECK_FALSE(reader.next());
  CHECK_FALSE(test::complaint_of<InputError>([&] { RawWriter again{path}; }).empty());  // nothing is overwritten

  CHECK(free_name(path) == path + ".1");
  CHECK(free_name(scratch.path("other.raw")) == scratch.path("other.raw"));

  test::write_bytes(scratch.path("bare"), std::string(100, 'x'));
  RawReader bare{scratch.path("bare"), 1'000'000, 100.0};
  std::size_t count = 0;
  Utime last = 0;
  while (const auto piece = bare.next()) {
    count += piece->bytes.size();
    last = piece->utime;
  }
  CHECK(count == 100);
  CHECK(last == 2'000'000);  // a second for a hundred bytes
  CHECK(test::complaint_of<InputError>([&] {
          RawReader none{scratch.path("none"), 0, 1.0};
        }).find("cannot be read") != std::string::npos);
}

TEST_CASE("link: a pseudo-terminal passes bytes both ways") {
  const Scratch scratch;
  Server instrument{"pty:" + scratch.path("tty")};
  Heard heard;
  Link link{Endpoint::parse("serial://" + scratch.path("tty") + "?baud=115200", "test"), heard.received(),
            heard.changed()};
  CHECK(until(link, [&] { return link.up(); }));
  const std::string binary{"\x00\x11\x13\x03\xFF\r\n\x7F", 8};  // nothing of it means anything to the line
  CHECK(instrument.send(binary) == binary.size());
  CHECK(until(link, [&] { return heard.bytes.size() >= binary.size(); }));
  CHECK(heard.bytes == binary);
  link.send(binary);
  link.wait({}, 20);
  CHECK(instrument.wait(1.0) == binary);
}

TEST_CASE("link: an instrument that drains its line leaves with nothing unread, however slow the reader") {
  const Scratch scratch;
  const std::string sent(6'000, 'x');  // more than the terminal's own buffer holds
  std::string read;
  std::thread reader;
  {
    Server instrument{"pty:" + scratch.path("tty")};
    const int line = ::open(scratch.path("tty").c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC);
    REQUIRE(line >= 0);
    reader = std::thread{[line, &read] {
      std::this_thread::sleep_for(std::chrono::milliseconds{600});  // a busy machine
      std::array<char, 512> bytes{};
      for (ssize_t count = 0; (count = ::read(line, bytes.data(), bytes.size())) > 0;) {
        read.append(bytes.data(), static_cast<std::size_t>(count));
      }
      ::close(line);
    }};
    CHECK(instrument.send(sent) == sent.size());
    instrument.drain();
  }
  reader.join();
  CHECK((read == sent));  // without thousands of letters should it fail
}

TEST_CASE("link: what waited in a line before it was opened is not taken for news") {
  const Scratch scratch;
  Server instrument{"pty:" + scratch.path("tty")};
  const std::string frame(220, 'o');  // old
  std::size_t sent = 0;
  const int stalled =
      ::open(scratch.path("tty").c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);  // by a driver that stands still
  REQUIRE(stalled >= 0);
  for (int i = 0; i < 30; ++i) sent += instrument.send(frame);
  CHECK(sent > 4096);  // more than the terminal's own buffer holds
  Heard heard;
  Link link{Endpoint::parse("serial://" + scratch.path("tty") + "?baud=115200", "test"), heard.received(),
            heard.changed()};
  ::close(stalled);
  CHECK(until(link, [&] { return link.up(); }));
  CHECK(instrument.send("new") == 3);
  CHECK(until(link, [&] { return heard.bytes.find("new") != std::string::npos; }));
  CHECK((heard.bytes == "new"));  // without thousands of letters should it fail
}

TEST_CASE("link: what came while the program stood still is not taken for news") {
  const Scratch scratch;
  for (const std::string& to : {"pty:" + scratch.path("tty"), std::string{"tcp:0"}}) {
    CAPTURE(to);
    Server instrument{to};
    const std::string there = to == "tcp:0" ? instrument.name() : "serial://" + scratch.path("tty") + "?baud=115200";
    const auto says = [&](std::string_view text) {
      (void)instrument.wait(0.0);  // whoever wants to connect
      return instrument.send(text) == text.size();
    };
    Heard heard;
    Link link{Endpoint::parse(there, "test"), heard.received(), heard.changed()};
    CHECK(until(link, [&] { return link.up(); }));
    CHECK(until(link, [&] { return says("a") && !heard.bytes.empty(); }));
    std::this_thread::sleep_for(std::chrono::milliseconds{400});  // a busy machine
    CHECK(says("b"));
    CHECK(until(link, [&] { return heard.bytes.find('b') != std::string::npos; }));
    CHECK(says("old"));
    std::this_thread::sleep_for(std::chrono::milliseconds{1'300});
    CHECK(until(link, [&] { return link.openings() == 2; }));
    REQUIRE(heard.changes.size() >= 2);
    CHECK(heard.changes[1].find("stood still for 1.") != std::string::npos);
    CHECK(until(link, [&] { return says("new") && heard.bytes.find("new") != std::string::npos; }));
    CHECK((heard.bytes.find("old") == std::string::npos));
  }
}

TEST_CASE("link: an instrument that goes and comes back is found again, and why it is gone is said") {
  Heard heard;
  std::string name;
  { name = Server{"tcp:0"}.name(); }  // a port that is free again
  Link link{Endpoint::parse(name, "test"), heard.received(), heard.changed()};
  CHECK(until(link, [&] { return heard.changes.size() >= 2; }));
  CHECK(heard.changes[0].find("nobody listens") != std::string::npos);
  const std::string port = name.substr(name.rfind(':') + 1);
  {
    Server instrument{"tcp:" + port};
    CHECK(until(link, [&] {
      (void)instrument.wait(0.0);
      return link.up();
    }));
    CHECK(until(link, [&] { return instrument.send("hello") == 5; }));
    CHECK(until(link, [&] { return heard.bytes == "hello"; }));
  }
  CHECK(until(link, [&] { return !link.up(); }));
  CHECK(heard.changes.back().find("closed the line") != std::string::npos);
  {
    Server again{"tcp:" + port};
    CHECK(until(link, [&] {
      (void)again.wait(0.0);
      return link.up();
    }));
    CHECK(link.openings() == 2);
    link.send(std::string{"nobody reads this, so that the end is a reset"});
    link.wait({}, 50);
  }
  CHECK(until(link, [&] { return !link.up(); }));
  CHECK(heard.changes.back().find("closed the line") != std::string::npos);
}

TEST_CASE("link: what cannot be opened is said with its remedy") {
  const auto why = [](const std::string& text) {
    Heard heard;
    Link link{Endpoint::parse(text, "test"), heard.received(), heard.changed()};
    until(link, [&] { return !heard.changes.empty(); });
    return heard.changes.empty() ? std::string{} : heard.changes[0];
  };
  CHECK(why("serial:///dev/none?baud=9600").find("no such device") != std::string::npos);
  CHECK(why("serial:///dev/null?baud=9600").find("no serial line") != std::string::npos);
  CHECK(why("tcp://some.name:80").find("in numbers") != std::string::npos);
}

TEST_CASE("link: a file is read to its end") {
  const Scratch scratch;
  test::write_bytes(scratch.path("bytes"), std::string(10'000, 'a'));
  Heard heard;
  Link link{Endpoint::parse("file://" + scratch.path("bytes"), "test"), heard.received(), heard.changed()};
  CHECK(until(link, [&] { return link.finished(); }));
  CHECK(heard.bytes.size() == 10'000);
}
