#include "processes/deputy/children.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>

#include "processes/deputy/host.hpp"

namespace fathom::deputy {
namespace {

struct Attributes {
  posix_spawnattr_t value{};
  Attributes() { posix_spawnattr_init(&value); }
  ~Attributes() { posix_spawnattr_destroy(&value); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;
};

struct Actions {
  posix_spawn_file_actions_t value{};
  Actions() { posix_spawn_file_actions_init(&value); }
  ~Actions() { posix_spawn_file_actions_destroy(&value); }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;
};

std::optional<std::string> environment_variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  if (value == nullptr) return {};
  return value;
}

std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>>& settings) {
  std::vector<std::string> all;
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view entry{*each};
    bool replaced = false;
    for (const auto& [name, value] : settings) replaced = replaced || entry.starts_with(name + "=");
    if (!replaced) all.emplace_back(entry);
  }
  for (const auto& [name, value] : settings) all.push_back(name + "=" + value);
  return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> all;
  all.reserve(texts.size() + 1);
  for (std::string& each : texts) all.push_back(each.data());
  all.push_back(nullptr);
  return all;
}

int open_terminal(std::string& name) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 128> path{};
  if (master < 0) return -1;
  if (grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, path.data(), path.size()) != 0) {
    close(master);
    return -1;
  }
  name = path.data();
  return master;
}

/// How we hear a child: a terminal, so that it prints line by line, or a pipe where there is none (a bare chroot).
struct Line {
  std::string terminal;  ///< empty: a pipe
  int ours{-1}, theirs{-1};
};

Line open_line() {
  Line line;
  line.ours = open_terminal(line.terminal);
  if (line.ours >= 0) return line;
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return line;
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {.terminal = "", .ours = ends[0], .theirs = ends[1]};
}

}  // namespace

Children::~Children() {
  for (auto& [id, child] : children_) close(child.terminal);
}

std::int32_t Children::start(const std::string& id, const std::string& exec) {
  launch::ExecLine line = launch::parse_exec(exec, environment_variable);
  const auto complain = [&](const std::string& what) {
    print_(id, "cannot be run: " + exec + "\r\n" + what + "\r\n");
    return 0;
  };
  if (line.words.empty()) return complain("it names no program");
  const Line heard = open_line();
  if (heard.ours < 0) return complain(std::string{"neither a terminal nor a pipe: "} + std::strerror(errno));

  // Signals as a program expects them; a session of its own, whose terminal is the first that it opens; none of ours.
  Attributes attributes;
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes.value, &none);
  posix_spawnattr_setsigdefault(&attributes.value, &all);
  posix_spawnattr_setflags(&attributes.value, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  Actions actions;
  const bool pipe = heard.terminal.empty();
  posix_spawn_file_actions_addopen(&actions.value, 0, pipe ? "/dev/null" : heard.terminal.c_str(), O_RDWR, 0);
  posix_spawn_file_actions_adddup2(&actions.value, pipe ? heard.theirs : 0, 1);
  posix_spawn_file_actions_adddup2(&actions.value, 1, 2);
  posix_spawn_file_actions_addclosefrom_np(&actions.value, 3);

  std::vector<std::string> environment = environment_with(line.settings);
  const std::vector<char*> arguments = pointers(line.words), variables = pointers(environment);
  pid_t pid{};
  const int error =
      posix_spawnp(&pid, arguments[0], &actions.value, &attributes.value, arguments.data(), variables.data());
  if (pipe) close(heard.theirs);
  if (error != 0) {
    close(heard.ours);
    return complain(line.words.front() + ": " + std::strerror(error));
  }
  children_[id] = {.pid = pid, .terminal = heard.ours};
  return pid;
}

void Children::signal(const std::string& id, int number) {
  const auto found = children_.find(id);
  if (found == children_.end()) return;
  found->second.signalled = true;
  for (const std::int32_t each : family_of(found->second.pid)) kill(each, number);
}

std::int32_t Children::pid(const std::string& id) const {
  const auto found = children_.find(id);
  return found == children_.end() ? 0 : found->second.pid;
}

void Children::watch(std::vector<pollfd>& into) const {
  for (const auto& [id, child] : children_) {
    if (!child.silent) into.push_back({.fd = child.terminal, .events = POLLIN, .revents = 0});
  }
}

void Children::drain(const std::string& id, Child& child) {
  constexpr int kAtOnce = 64;  // then others get their turn, even beside a program that prints without pause
  std::array<char, 4096> buffer{};
  for (int i = 0; i < kAtOnce && !child.silent; ++i) {
    const ssize_t length = ::read(child.terminal, buffer.data(), buffer.size());
    if (length > 0) {
      print_(id, {buffer.data(), static_cast<std::size_t>(length)});
    } else if (length == 0 || (errno != EAGAIN && errno != EINTR)) {
      child.silent = true;  // to close our side now would hang up on a program that is about to end well
    } else {
      return;
    }
  }
}

void Children::read() {
  for (auto& [id, child] : children_) drain(id, child);
}

void Children::reap() {
  for (auto each = children_.begin(); each != children_.end();) {
    int status{};
    if (waitpid(each->second.pid, &status, WNOHANG) != each->second.pid) {
      ++each;
      continue;
    }
    const std::string id = each->first;
    drain(id, each->second);
    if (each->second.signalled) {  // what it leaves behind was told to end as well
      for (const std::int32_t left : family_of(each->second.pid)) {
        if (left != each->second.pid) kill(left, SIGKILL);
      }
    }
    close(each->second.terminal);
    each = children_.erase(each);
    death_(id, status);
  }
}

}  // namespace fathom::deputy
