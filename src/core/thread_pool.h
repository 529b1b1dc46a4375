// A pool of worker threads that sleep when idle. No spinning: the machine may be shared.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace aligngs {

class ThreadPool {
 public:
  /// threads == 0: one per hardware thread. The calling thread counts as one of them.
  explicit ThreadPool(int threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls body(begin, end, worker) on consecutive chunks of [0, count), at most `grain` long each, in
  /// any order and on any thread; worker is in [0, size()). Returns when all are done; the first
  /// exception is rethrown here. Must not be called from inside a body.
  ///
  /// Results are independent of the number of threads when each chunk writes only its own output:
  /// chunk boundaries depend on count and grain alone.
  void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end, int worker)>& body);

 private:
  struct Job;
  void work(int worker);
  static void run_chunks(Job& job, int worker);

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_, done_;
  Job* job_ = nullptr;
  size_t generation_ = 0;
  int active_ = 0;
  bool stopping_ = false;
};

}  // namespace aligngs
