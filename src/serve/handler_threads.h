// Threads for what takes long, while pages and events go on being served by the server's own.
#pragma once

#include <exception>
#include <optional>

#include "serve/http_answer.h"
#include "serve/http_types.h"

namespace aligngs {

/// Counts up for as long as it lives.
template <class Number>
class Counted {
 public:
  explicit Counted(Number& count) : count_(count) { ++count_; }
  ~Counted() { --count_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  Number& count_;
};

/// Failure of a handler, as an error for the page.
Error error_of(const std::exception_ptr& failure);

/// Handlers of one lane run one after the other.
enum class HandlerLane {
  kInTurn,  ///< those that may take long
  kPrompt   ///< those that answer at once, whatever the others do
};

class HandlerThreads {
 public:
  HandlerThreads() = default;
  /// Waits for the work that runs.
  ~HandlerThreads();
  HandlerThreads(const HandlerThreads&) = delete;
  HandlerThreads& operator=(const HandlerThreads&) = delete;

  /// Runs a handler; what it throws becomes an answer. When too many of its lane wait the answer is status 503.
  template <class Result, class Work>
  net::awaitable<std::optional<Result>> handled(const Request& request, const Work& work,
                                                std::optional<HttpAnswer>& failed,
                                                HandlerLane lane = HandlerLane::kInTurn) {
    size_t& waiting = waiting_[static_cast<size_t>(lane)];
    if (waiting >= kMostWaiting) {
      failed = refusal(request, http::status::service_unavailable, "too many requests wait");
      co_return std::nullopt;
    }
    const Counted turn(waiting);
    std::exception_ptr failure;
    std::optional<Result> result;
    try {
      result = co_await run_on<Result>(lane == HandlerLane::kPrompt ? prompt_ : workers_, work);
    } catch (...) {
      failure = std::current_exception();
    }
    if (failure) failed = refusal(request, error_of(failure));
    co_return result;
  }

  /// Runs work that is no handler and must not wait for one.
  template <class Result, class Work>
  net::awaitable<Result> beside_handlers(const Work& work) {
    co_return co_await run_on<Result>(compressors_, work);
  }

 private:
  static constexpr size_t kMostWaiting = 16;  // handlers

  template <class Result, class Work>
  net::awaitable<Result> run_on(net::thread_pool& pool, const Work& work) {
    co_return co_await net::co_spawn(
        pool.get_executor(), [&work]() -> net::awaitable<Result> { co_return work(); }, net::use_awaitable);
  }

  size_t waiting_[2] = {0, 0};  ///< by lane
  net::thread_pool compressors_{1}, workers_{1}, prompt_{1};
};

}  // namespace aligngs
