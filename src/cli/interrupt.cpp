#include "cli/interrupt.hpp"

#include <csignal>

namespace grainvdb::cli {
namespace {

volatile std::sig_atomic_t noted = 0;

extern "C" void note(int signal) {
  noted = signal;
}

}  // namespace

void watch_for_interrupts() {
  struct sigaction action = {};
  action.sa_handler = &note;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void check_for_interrupt() {
  if (noted != 0) throw Interrupted{static_cast<int>(noted)};
}

}  // namespace grainvdb::cli
