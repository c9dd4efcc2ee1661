// The single checks of fathom doctor.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/operator_key.hpp"
#include "common/runtime/bus.hpp"
#include "common/runtime/bus_filter.hpp"
#include "processes/fathom/bus/doctor.hpp"

namespace fathom::tool {
namespace {

namespace fs = std::filesystem;
using Grade = Finding::Grade;

bool in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders{path == nullptr ? "" : path};
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path{folder} / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

long kernel_number(const std::string& path) {
  std::ifstream file{path};
  long value{-1};
  file >> value;
  return value;
}

/// A bus on a port that nobody else uses, with one message of our own to listen for.
class OwnBus {
 public:
  OwnBus()
      : url_{runtime::Url::parse("udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000) + "?ttl=0",
                                 "--bus")},
        input_{{url_}, {{kChannel, 1}}},
        output_{url_} {}

  /// Over the multicast address: it comes back to us.
  [[nodiscard]] bool comes_back() {
    std::vector<std::uint8_t> bytes(100, 1);
    output_.write(kChannel, bytes, 0);
    return heard(2.0);
  }
  /// To this host alone, as any other host could send it.
  [[nodiscard]] bool believes_what_is_sent_past_it() {
    const std::string packet = std::string("LC02\0\0\0\1", 8) + kChannel + std::string(1, '\0') + std::string(100, 'x');
    const int from = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_port = htons(runtime::BusAddress::of(url_.text).port);
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto sent =
        sendto(from, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&here), sizeof here);
    close(from);
    return sent < 0 || heard(0.3);  // over lo it is there at once
  }

 private:
  static constexpr char kChannel[] = "DOCTOR";
  [[nodiscard]] bool heard(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      input_.wait(-1, 50);
      if (input_.next()) return true;
    }
    return false;
  }
  runtime::Url url_;
  runtime::LiveInput input_;
  runtime::Output output_;
};

Finding check_camera(const std::string& device) {
  if (device.find("://") != std::string::npos) return {Grade::kWell, "camera", device + " (not tried)", ""};
  if (!fs::exists(device)) return {Grade::kBad, "camera", device + " is not there", "plugged in? see: ls /dev/video*"};
  if (access(device.c_str(), R_OK | W_OK) != 0) {
    return {Grade::kBad, "camera", device + " may not be opened by you",
            "sudo usermod -aG video $USER, then log in anew"};
  }
  return {Grade::kWell, "camera", device, ""};
}

Finding check_device(const std::string& driver, const std::string& link) {
  const auto colon = link.find("://");
  const std::string kind = link.substr(0, colon == std::string::npos ? 0 : colon);
  const std::string what = driver.substr(0, driver.find("_driver"));
  if (kind != "serial" && kind != "i2c") return {Grade::kWell, what, link + " (not tried: it is no file)", ""};
  const std::string path =
      link.substr(colon + 3, link.find('?') == std::string::npos ? link.npos : link.find('?') - colon - 3);
  if (!fs::exists(path)) {
    return {Grade::kBad, what, path + " is not there", "plugged in? see: ls /dev/serial/by-id; then correct the link"};
  }
  if (access(path.c_str(), R_OK | W_OK) != 0) {
    const std::string group = kind == "i2c" ? "i2c" : "dialout";
    return {Grade::kBad, what, path + " may not be opened by you",
            "sudo usermod -aG " + group + " $USER, then log in anew"};
  }
  return {Grade::kWell, what, path, ""};
}

}  // namespace

std::vector<Finding> check_programs() {
  struct Needed {
    const char *program, *package, *use;
    bool must;
  };
  constexpr Needed kNeeded[] = {{"lcm-logger", "liblcm-bin", "records", true},
                                {"lcm-logplayer", "liblcm-bin", "replays", true},
                                {"gnuplot", "gnuplot-nox", "draws the report", true},
                                {"ip", "iproute2", "sets up the network", true},
                                {"lcm-spy", "liblcm-java libjchart2d-java default-jre", "shows messages", false}};
  std::vector<Finding> all;
  std::string there;
  for (const Needed& each : kNeeded) {
    if (in_path(each.program)) {
      there += (there.empty() ? "" : ", ") + std::string{each.program};
    } else {
      all.push_back({each.must ? Grade::kBad : Grade::kRemark, "programs",
                     std::string{each.program} + " is missing (" + each.use + ")",
                     std::string{"sudo apt-get install "} + each.package});
    }
  }
  if (!there.empty()) all.insert(all.begin(), {Grade::kWell, "programs", there, ""});
  return all;
}

std::vector<Finding> check_network(const std::string& url) {
  std::vector<Finding> all;
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  inet_pton(AF_INET, "239.255.76.67", &address.sin_addr);
  const bool route = connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  if (!route) {
    return {{Grade::kBad, "network", "no route to LCM's multicast address",
             "sudo ip link set lo up; sudo ip route add 224.0.0.0/4 dev lo src 127.0.0.1"}};
  }
  std::string trouble;
  try {
    OwnBus bus;
    if (!bus.comes_back()) {
      trouble = "what is sent does not come back";
    } else if (bus.believes_what_is_sent_past_it()) {
      all.push_back({Grade::kBad, "strangers", "what is sent to this host past the bus is believed, from any host",
                     "keep it out by a firewall: docs/operations.md, Who is believed"});
    } else {
      all.push_back({Grade::kWell, "strangers", "what is sent to this host past the bus is refused", ""});
    }
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  if (trouble.empty()) {
    all.push_back({Grade::kWell, "network", "a message comes back over multicast", ""});
  } else {
    all.push_back({Grade::kBad, "network", trouble,
                   "does a firewall hold it? sudo nft list ruleset; ip route get 239.255.76.67"});
  }
  try {
    (void)runtime::Url::parse(url, "--bus");
    const bool far = url.find("ttl=") != std::string::npos && url.find("ttl=0") == std::string::npos;
    all.push_back({far ? Grade::kRemark : Grade::kWell, "bus",
                   url + (far ? ": messages leave this host" : ": messages stay on this host"),
                   far ? "keep strangers off this network, see docs/operations.md" : ""});
  } catch (const InputError& error) {
    all.push_back({Grade::kBad, "bus", error.what(), "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=0'"});
  }
  return all;
}

std::vector<Finding> check_buffers() {
  constexpr long kWanted = 2'097'152;  // B: a raw picture and what comes behind it
  const long most = kernel_number("/proc/sys/net/core/rmem_max"),
             usual = kernel_number("/proc/sys/net/core/rmem_default");
  std::vector<Finding> all;
  const auto judge = [&](const char* name, long value, const char* loss) {
    const std::string text = std::string{name} + " is " + std::to_string(value);
    if (value >= kWanted) {
      all.push_back({Grade::kWell, "buffers", text, ""});
    } else {
      all.push_back(
          {Grade::kRemark, "buffers", text + ": " + loss,
           "sudo sysctl -w " + std::string{name} + "=" + std::to_string(kWanted) + " (and in /etc/sysctl.d)"});
    }
  };
  judge("net.core.rmem_max", most, "pictures above 200 kB may be lost");
  judge("net.core.rmem_default", usual, "lcm-spy loses large messages");
  return all;
}

Finding check_clock() {
  constexpr std::time_t kYear2024 = 1'704'067'200;
  if (std::time(nullptr) < kYear2024)
    return {Grade::kBad, "clock", "shows a time before 2024", "sudo timedatectl set-ntp true"};
  timex clock{};
  const int state = adjtimex(&clock);
  if (state < 0 || state == TIME_ERROR || (clock.status & STA_UNSYNC) != 0) {
    return {Grade::kRemark, "clock",
            "is not kept by a time server: orders between hosts that differ by a minute are refused",
            "sudo apt-get install chrony"};
  }
  return {Grade::kWell, "clock", "is kept by a time server", ""};
}

Finding check_disk(const std::string& folder) {
  constexpr double kPerHour = 0.5e9;  // B: all channels of a trial without pictures
  constexpr double kLeast = 1e9;      // B
  struct statvfs status {};
  if (statvfs(folder.c_str(), &status) != 0) {
    return {Grade::kBad, "disk", folder + ": " + std::strerror(errno), "mkdir -p " + folder};
  }
  const std::string probe = (fs::path{folder} / (".fathom-" + std::to_string(getpid()))).string();
  std::ofstream file{probe};
  file << "probe" << std::flush;
  const bool writes = static_cast<bool>(file);
  file.close();
  std::error_code ignored;
  fs::remove(probe, ignored);
  if (!writes)
    return {Grade::kBad, "disk", folder + " cannot be written", "sudo chown $USER " + folder + ", or another --run"};
  const double free = static_cast<double>(status.f_bavail) * static_cast<double>(status.f_frsize);
  char text[160];
  std::snprintf(text, sizeof text, "%s has %.1f GB free, about %.0f h of a trial without pictures", folder.c_str(),
                free * 1e-9, free / kPerHour);
  if (free < kLeast) return {Grade::kBad, "disk", text, "remove old logs: ls -lhS " + folder};
  return {Grade::kWell, "disk", text, ""};
}

std::vector<Finding> check_devices(const std::string& path) {
  std::vector<Finding> all;
  const Config config = Config::load(path);
  for (const std::string& driver : config.keys()) {
    if (!driver.ends_with("_driver") || !config.is_section(driver)) continue;
    const Config section = config.section(driver);
    if (section.has("link")) all.push_back(check_device(driver, section.text("link")));
    if (section.has("device")) all.push_back(check_camera(section.text("device")));
  }
  if (all.empty())
    all.push_back({Grade::kRemark, "devices", path + " names no driver's link", "give the drivers' file"});
  return all;
}

Finding check_operator(const std::string& file) {
  try {
    if (operator_keys(file).known_to_all) {
      return {Grade::kRemark, "operator", file + " is the one that everybody knows: for simulations only",
              std::string{"make your own: "} + kMakeKey};
    }
  } catch (const InputError& error) {
    return {Grade::kBad, "operator", error.what(), ""};
  }
  return {Grade::kWell, "operator", file, ""};
}

}  // namespace fathom::tool
