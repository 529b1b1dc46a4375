// How many connections the server holds, and which one makes room for a new one.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <optional>

namespace aligngs {

/// Places for connections. When all are taken, the one that has been silent longest is closed: idle connections never
/// keep a page out. Used from one thread.
class ConnectionSlots {
  struct Entry {
    std::function<void()> close;
    bool idle = true;  ///< it waits for a request
    bool closed = false;
  };
  using Entries = std::list<Entry>;  // those idle for longest come first

 public:
  explicit ConnectionSlots(size_t most) : most_(most) {}
  ConnectionSlots(const ConnectionSlots&) = delete;
  ConnectionSlots& operator=(const ConnectionSlots&) = delete;

  /// One connection's place, given back at its end. It begins idle.
  class Slot {
   public:
    Slot(ConnectionSlots& owner, Entries::iterator entry) : owner_(&owner), entry_(entry) {}
    Slot(Slot&& other) noexcept;
    Slot& operator=(Slot&&) = delete;
    ~Slot();
    void idle();  ///< waits for the next request
    void busy();  ///< answers one
    /// The connection has been closed for another one.
    bool closed() const { return entry_->closed; }

   private:
    ConnectionSlots* owner_;
    Entries::iterator entry_;
  };

  /// A place, or nothing when every connection is at work. `close` ends this connection and must not throw.
  std::optional<Slot> take(std::function<void()> close);
  size_t taken() const { return open_; }

 private:
  const size_t most_;
  size_t open_ = 0;  ///< entries that are not closed
  Entries entries_;
};

}  // namespace aligngs
