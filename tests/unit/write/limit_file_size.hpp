#pragma once
/// Makes writes fail, as on a full disk, wherever a file would become larger than a limit.
#include <csignal>
#include <cstdint>
#include <stdexcept>

#include <sys/resource.h>

namespace grainvdb::testing {

/// For as long as it lives, no file of this process can grow beyond `bytes`: writes fail with EFBIG. Needs no rights.
class LimitFileSize {
 public:
  explicit LimitFileSize(std::uint64_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_FSIZE, &limit) != 0) throw std::runtime_error("no file size limit");
    former_ = limit.rlim_cur;
    limit.rlim_cur = bytes;
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) throw std::runtime_error("no file size limit");
  }
  ~LimitFileSize() {
    rlimit limit{};
    ::getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = former_;
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, handler_);
  }
  LimitFileSize(const LimitFileSize&) = delete;
  LimitFileSize& operator=(const LimitFileSize&) = delete;

 private:
  void (*handler_)(int);
  rlim_t former_ = RLIM_INFINITY;
};

}  // namespace grainvdb::testing
