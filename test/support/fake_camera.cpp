// A V4L2 camera that is not there, for hosts without one: preloaded (LD_PRELOAD) into a process, it answers the system
// calls on one path as the kernel's uvcvideo does, so that the libraries' own way to a camera is run. What it cannot
// show: USB, a driver's own faults, exposure. FAKE_CAMERA: the path, and behind commas
//   yuyv | mjpg     what it delivers; mjpg from the file in FAKE_CAMERA_JPEG
//   clock=C         of the stamps: monotonic, realtime, none (zero)
//   age=MS          of a picture when it is ready
//   first=MS        from the stream's start to its first picture
//   unplug=N, hang=N  after N pictures the device is gone, or silent
//   back=MS         this long after it was unplugged it is there again
//   busy            another program streams
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/mman.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace {

constexpr unsigned kWidth = 640, kHeight = 480, kBuffers = 4, kRoom = kWidth * kHeight * 2;
constexpr long kPeriod = 33'333'333;  // ns

template <class Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

double now(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Camera {
  std::string text, path;
  std::set<int> open;  // timers stand in for the device: poll and select work on them as they are
  std::array<void*, kBuffers> memory{};
  std::vector<unsigned> queued;
  std::vector<char> jpeg;
  int pictures{};
  unsigned requested{};
  double unplugged_at{-1.0};
  bool streaming{false};
  std::mutex mutex;

  Camera() {
    const char* given = std::getenv("FAKE_CAMERA");
    text = given == nullptr ? "" : given;
    path = text.substr(0, text.find(','));
    if (const char* file = std::getenv("FAKE_CAMERA_JPEG")) {
      std::ifstream in{file, std::ios::binary};
      jpeg.assign(std::istreambuf_iterator<char>{in}, {});
    }
  }
  [[nodiscard]] bool says(const char* word) const { return text.find(std::string{","} + word) != std::string::npos; }
  [[nodiscard]] double number(const char* key, double otherwise) const {
    const auto at = text.find(std::string{","} + key + "=");
    return at == std::string::npos ? otherwise : std::atof(text.c_str() + at + std::strlen(key) + 2);
  }
  [[nodiscard]] unsigned format() const { return says("mjpg") ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_YUYV; }
  // Unplugged for good, or until it is back.
  bool gone() {
    if (unplugged_at < 0.0) {
      if (pictures < static_cast<int>(number("unplug", 1e9))) return false;
      unplugged_at = now(CLOCK_MONOTONIC);
    }
    return now(CLOCK_MONOTONIC) - unplugged_at < 1e-3 * number("back", 1e12);
  }
  void tick(int fd) const {
    const double wait = pictures > 0 ? 1e-9 * kPeriod : 1e-3 * number("first", 1e-6 * kPeriod);
    const timespec first{.tv_sec = static_cast<time_t>(wait),
                         .tv_nsec = static_cast<long>(1e9 * (wait - std::floor(wait)))};
    const itimerspec each{.it_interval = {.tv_sec = 0, .tv_nsec = kPeriod}, .it_value = first};
    const itimerspec never{};
    timerfd_settime(fd, 0, pictures >= static_cast<int>(number("hang", 1e9)) ? &never : &each, nullptr);
  }
};

Camera& camera() {
  static Camera one;
  return one;
}

int fail(int why) {
  errno = why;
  return -1;
}

int describe(v4l2_format& format) {
  format.fmt.pix.width = kWidth;
  format.fmt.pix.height = kHeight;
  format.fmt.pix.pixelformat = camera().format();
  format.fmt.pix.field = V4L2_FIELD_NONE;
  format.fmt.pix.bytesperline = 2 * kWidth;
  format.fmt.pix.sizeimage = kRoom;
  format.fmt.pix.colorspace = V4L2_COLORSPACE_SRGB;
  return 0;
}

// A slanting ramp that moves, or the file.
unsigned paint(void* to, int number) {
  auto* bytes = static_cast<unsigned char*>(to);
  if (camera().says("mjpg")) {
    const std::size_t size = std::min<std::size_t>(camera().jpeg.size(), kRoom);
    std::memcpy(bytes, camera().jpeg.data(), size);
    return static_cast<unsigned>(size);
  }
  for (unsigned y = 0; y < kHeight; ++y) {
    for (unsigned x = 0; x < kWidth; ++x, bytes += 2) {
      bytes[0] = static_cast<unsigned char>(40 + (x + y + 4U * static_cast<unsigned>(number)) % 160U);
      bytes[1] = 128;
    }
  }
  return kRoom;
}

int dequeue(int fd, v4l2_buffer& buffer) {
  Camera& c = camera();
  if (c.gone()) return fail(ENODEV);
  std::uint64_t ticks = 0;
  if (c.queued.empty() || read(fd, &ticks, sizeof ticks) != static_cast<ssize_t>(sizeof ticks)) return fail(EAGAIN);
  const unsigned index = c.queued.front();
  c.queued.erase(c.queued.begin());
  buffer = {};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  buffer.length = kRoom;
  buffer.bytesused = paint(c.memory[index], c.pictures++);
  buffer.flags = V4L2_BUF_FLAG_MAPPED | V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  const double t =
      (c.says("clock=realtime") ? now(CLOCK_REALTIME) : now(CLOCK_MONOTONIC)) - 1e-3 * c.number("age", 0.0);
  if (!c.says("clock=none")) {
    buffer.timestamp.tv_sec = static_cast<time_t>(t);
    buffer.timestamp.tv_usec = static_cast<suseconds_t>(1e6 * (t - static_cast<double>(buffer.timestamp.tv_sec)));
  }
  buffer.sequence = static_cast<unsigned>(c.pictures);
  if (c.pictures >= static_cast<int>(c.number("hang", 1e9))) c.tick(fd);
  return 0;
}

int answer(int fd, unsigned long request, void* data) {
  Camera& c = camera();
  const std::lock_guard lock{c.mutex};
  if (c.gone()) return fail(ENODEV);
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& able = *static_cast<v4l2_capability*>(data);
      able = {};
      std::strcpy(reinterpret_cast<char*>(able.driver), "fake");
      std::strcpy(reinterpret_cast<char*>(able.card), "Fake camera");
      able.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      able.capabilities = able.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_G_FMT:
      return describe(*static_cast<v4l2_format*>(data));
    case VIDIOC_S_FMT:
    case VIDIOC_TRY_FMT:
      if (c.says("busy")) return fail(EBUSY);
      return describe(*static_cast<v4l2_format*>(data));
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      auto& rate = static_cast<v4l2_streamparm*>(data)->parm.capture;
      rate.capability = V4L2_CAP_TIMEPERFRAME;
      rate.timeperframe = {.numerator = 1, .denominator = 30};
      return 0;
    }
    case VIDIOC_REQBUFS: {
      if (c.says("busy")) return fail(EBUSY);
      auto& wanted = *static_cast<v4l2_requestbuffers*>(data);
      wanted.count = std::min(wanted.count, kBuffers);
      c.requested = wanted.count;
      c.queued.clear();
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(data);
      if (buffer.index >= c.requested) return fail(EINVAL);
      buffer.length = kRoom;
      buffer.m.offset = buffer.index * kRoom;
      return 0;
    }
    case VIDIOC_QBUF:
      c.queued.push_back(static_cast<v4l2_buffer*>(data)->index);
      return 0;
    case VIDIOC_DQBUF:
      return dequeue(fd, *static_cast<v4l2_buffer*>(data));
    case VIDIOC_STREAMON:
      if (c.says("busy")) return fail(EBUSY);
      c.streaming = true;
      c.tick(fd);
      return 0;
    case VIDIOC_STREAMOFF:
      c.streaming = false;
      c.queued.clear();
      return 0;
    default:
      return fail(ENOTTY);
  }
}

int open_fake() {
  Camera& c = camera();
  const std::lock_guard lock{c.mutex};
  if (c.gone()) return fail(ENOENT);
  const int fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  c.open.insert(fd);
  return fd;
}

bool is_camera(const char* path) { return !camera().path.empty() && camera().path == path; }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : mode_t{};
  va_end(rest);
  if (is_camera(path)) return open_fake();
  return real<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : mode_t{};
  va_end(rest);
  if (is_camera(path)) return open_fake();
  return real<int (*)(const char*, int, ...)>("open64")(path, flags, mode);
}

int ioctl(int fd, unsigned long request, ...) {
  va_list rest;
  va_start(rest, request);
  void* data = va_arg(rest, void*);
  va_end(rest);
  if (camera().open.contains(fd)) return answer(fd, request, data);
  return real<int (*)(int, unsigned long, ...)>("ioctl")(fd, request, data);
}

void* mmap(void* where, std::size_t length, int protection, int flags, int fd, off_t offset) {
  const auto map = real<void* (*)(void*, std::size_t, int, int, int, off_t)>("mmap");
  if (fd < 0 || !camera().open.contains(fd)) return map(where, length, protection, flags, fd, offset);
  void* memory = map(nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  camera().memory[static_cast<std::size_t>(offset) / kRoom] = memory;
  return memory;
}

void* mmap64(void* where, std::size_t length, int protection, int flags, int fd, off_t offset) {
  return mmap(where, length, protection, flags, fd, offset);
}

int close(int fd) {
  camera().open.erase(fd);
  return real<int (*)(int)>("close")(fd);
}
}
