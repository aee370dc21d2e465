#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace burrhole {

void for_each_number(int count, std::size_t most_threads, const std::function<void(int)>& f) {
  std::atomic<int> next{0};
  std::exception_ptr thrown;  // the first; an exception must not leave a thread
  std::mutex guard;
  const auto run = [&] {
    try {
      for (int n = next++; n < count; n = next++) f(n);
    } catch (...) {
      const std::scoped_lock lock(guard);
      if (thrown == nullptr) thrown = std::current_exception();
      next = count;
    }
  };
  const std::size_t threads =
      std::min({most_threads, static_cast<std::size_t>(std::max(count, 1)), static_cast<std::size_t>(std::thread::hardware_concurrency())});
  {
    std::vector<std::jthread> others;
    try {
      while (others.size() + 1 < threads) others.emplace_back(run);
    } catch (const std::system_error&) {
    }  // fewer threads do as well
    run();
  }
  if (thrown != nullptr) std::rethrow_exception(thrown);
}

void for_each_number(int count, const std::function<void(int)>& f) { for_each_number(count, std::numeric_limits<std::size_t>::max(), f); }

}  // namespace burrhole
