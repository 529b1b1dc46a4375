#include "batch/worker.h"

#include <algorithm>
#include <chrono>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "batch/memory_forecast.h"
#include "core/log.h"
#include "core/progress.h"
#include "core/stop_signal.h"

namespace aligngs {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTick = std::chrono::milliseconds(50);  // how soon the end of a room or a signal is seen
// A cluster kills the processes of a job one after the other: a worker that outlives this was not meant.
constexpr auto kOwnDeath = std::chrono::milliseconds(1000);
constexpr auto kLookPause = std::chrono::milliseconds(1000);  // between two looks at a room of somebody else

/// A room that is not done, as far as this worker knows.
struct Waiting {
  RoomEntry room;
  uint64_t predicted_bytes = 0;     ///< 0: not asked yet
  Clock::time_point next_look{};    ///< not before this
  std::optional<LeaseView> seen{};  ///< the lease of somebody else when it was first seen
  bool alive_elsewhere = false;     ///< it was renewed since
};

class Worker {
 public:
  Worker(const BatchFolder& folder, const Batch& batch, const std::vector<RoomEntry>& rooms,
         const WorkerOptions& options)
      : folder_(folder), batch_(batch), options_(options), total_(rooms.size()) {
    for (const RoomEntry& room : rooms) waiting_.push_back({.room = room});
  }

  WorkerSummary work() {
    // Rooms write their checkpoints first, however long that takes.
    const StopDeferral deferral;
    for (;;) {
      if (stop_requested() && !summary_.interrupted) stop_rooms();
      if (!summary_.interrupted) start_rooms();
      settle_rooms();
      if (running_.empty() && (summary_.interrupted || nothing_left())) break;
      std::this_thread::sleep_for(kTick);
    }
    for (const Waiting& left : waiting_)
      (left.alive_elsewhere ? summary_.elsewhere : summary_.stopped).push_back(left.room.name);
    return summary_;
  }

 private:
  bool nothing_left() const {
    return std::all_of(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return w.alive_elsewhere; });
  }

  void stop_rooms() {
    summary_.interrupted = true;
    if (!running_.empty())
      log_info("waiting for the checkpoints of {} room{}", running_.size(), running_.size() == 1 ? "" : "s");
    for (const auto& attempt : running_) attempt->ask_to_stop();
  }

  void start_rooms() {
    for (auto w = waiting_.begin(); w != waiting_.end() && running_.size() < static_cast<size_t>(options_.jobs);) {
      if (stop_requested()) return;
      const bool gone = Clock::now() >= w->next_look && look_at(*w);
      w = gone ? waiting_.erase(w) : std::next(w);
    }
  }

  /// True where the room is settled or started.
  bool look_at(Waiting& w) {
    w.next_look = Clock::now() + kLookPause;
    const LeaseView lease = look_at_lease(folder_.leases(), w.room.name, options_.times);
    if (lease.held()) {
      if (!w.seen) w.seen = lease;
      w.alive_elsewhere = lease.number != w.seen->number || lease.touched != w.seen->touched;
      return false;
    }
    w.seen.reset();
    w.alive_elsewhere = false;
    if (is_settled(w.room)) return true;
    if (!fits(w)) return false;
    if (lease.stale)
      log_info("{}: its worker on {} is gone, so that this one goes on", w.room.name,
               lease.host.empty() ? "another machine" : lease.host);
    std::optional<Lease> own = Lease::take(folder_.leases(), w.room.name, options_.times);
    if (!own) return false;
    if (is_settled(w.room)) return true;  // by somebody who gave the lease back just now
    start(w, std::move(*own));
    return true;
  }

  bool is_settled(const RoomEntry& room) {
    record_ = read_room_record(folder_.record(room.name));
    inputs_ = digest_inputs(batch_, room, record_ ? record_->inputs : InputDigest{});
    const RoomState state = settled_state(folder_, room, record_, inputs_);
    if (state == RoomState::kDone) summary_.done.push_back(room.name);
    if (state == RoomState::kFailed) {
      log_warning("{}: failed earlier: {}", room.name, record_->message);
      summary_.failed.push_back(room.name);
    }
    return state == RoomState::kDone || state == RoomState::kFailed;
  }

  /// Whether the room's share of memory is free. A room that is too large for the budget runs alone.
  bool fits(Waiting& w) {
    if (options_.memory_bytes == 0 || options_.jobs == 1) return true;
    if (w.predicted_bytes == 0) w.predicted_bytes = predicted_room_bytes(folder_, batch_, w.room);
    uint64_t used = 0;
    for (const auto& attempt : running_) used += attempt->memory_bytes();
    return running_.empty() || used + share_of(w) <= options_.memory_bytes;
  }

  uint64_t share_of(const Waiting& w) const {
    return memory_share(w.predicted_bytes, options_.memory_bytes, options_.jobs);
  }

  void start(const Waiting& w, Lease lease) {
    AttemptOptions attempt = options_.attempt;
    attempt.memory_bytes = w.predicted_bytes > 0 ? share_of(w) : 0;
    running_.push_back(
        std::make_unique<RoomAttempt>(folder_, batch_, w.room, std::move(lease), record_, inputs_, attempt));
    begun_[w.room.name] = Clock::now();
    log_info("{}: started, {} of {} rooms are settled", w.room.name, summary_.done.size() + summary_.failed.size(),
             total_);
  }

  void settle_rooms() {
    for (auto attempt = running_.begin(); attempt != running_.end();) {
      const bool lost = (*attempt)->lost();
      if (!lost && !(*attempt)->ended()) {
        ++attempt;
        continue;
      }
      const RoomEntry room = (*attempt)->room();
      if (lost) {
        log_warning("{}: another worker took it, since this one was away for too long", room.name);
        waiting_.push_back({.room = room});
      } else {
        if ((*attempt)->killed()) std::this_thread::sleep_for(kOwnDeath);
        report(room, (*attempt)->settle(summary_.interrupted || stop_requested()));
      }
      attempt = running_.erase(attempt);
      for (Waiting& w : waiting_) w.seen.reset();  // workers that were alive may be gone by now
      for (Waiting& w : waiting_) w.alive_elsewhere = false;
    }
  }

  void report(const RoomEntry& room, const RoomRecord& record) {
    if (record.state == AttemptState::kDone) {
      const double seconds = std::chrono::duration<double>(Clock::now() - begun_[room.name]).count();
      summary_.done.push_back(room.name);
      log_info("{}: done in {}", room.name, format_duration(seconds));
    } else if (record.state == AttemptState::kStopped) {
      summary_.stopped.push_back(room.name);
      log_info("{}: stopped, goes on when the command is run again", room.name);
    } else {
      summary_.failed.push_back(room.name);
      log_error("{}: {}", room.name, record.message);
    }
  }

  const BatchFolder& folder_;
  const Batch& batch_;
  const WorkerOptions& options_;
  size_t total_;
  std::list<Waiting> waiting_;
  std::list<std::unique_ptr<RoomAttempt>> running_;
  std::map<std::string, Clock::time_point> begun_;
  std::optional<RoomRecord> record_;  ///< of the room that is looked at
  InputDigest inputs_;
  WorkerSummary summary_;
};

}  // namespace

WorkerSummary work_on(const BatchFolder& folder, const Batch& batch, const std::vector<RoomEntry>& rooms,
                      const WorkerOptions& options) {
  return Worker(folder, batch, rooms, options).work();
}

}  // namespace aligngs
