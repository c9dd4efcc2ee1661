// recorder: everything that is said in a lockstep run, into one log with virtual times.
#include "common/runtime/recorder.hpp"

int main(int argc, char** argv) { return fathom::runtime::recorder_main(argc, argv); }
