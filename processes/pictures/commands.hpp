// The subcommands of `fathom` that read pictures. They live in a program of their own beside it, which `fathom` starts:
// OpenCV's readers of pictures and videos load some 200 libraries, and the other commands shall not wait for them.
#pragma once

namespace CLI {
class App;
}

namespace fathom::pictures {

void add_track(runtime::CommandLine& app);
void add_calibrate(runtime::CommandLine& app);

}  // namespace fathom::pictures
