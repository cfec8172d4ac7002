#pragma once
/// Orderly ending on Ctrl-C: the run notices between two frames, and its sinks remove what they wrote.

namespace grainvdb::cli {

/// Thrown where an interrupt is noticed.
struct Interrupted {
  int signal;
};

/// From now on the first SIGINT or SIGTERM is noted; a second one ends the process at once.
void watch_for_interrupts();

/// Throws Interrupted when one was noted.
void check_for_interrupt();

}  // namespace grainvdb::cli
