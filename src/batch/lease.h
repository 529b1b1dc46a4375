// The lease of a room tells which worker has it. It is a file that its holder touches now and then. Workers on any
// number of machines need nothing but a folder that they share.
//
// Leases of one room are numbered: ROOM.1, ROOM.2, ... The highest one counts. Whoever takes a room creates the next
// number with O_EXCL, so that one of several takers wins. A stale lease is taken over in the same way. Others never
// rename or remove a lease that counts. Ages are differences of times that the file system itself gives, so that clocks
// of machines may differ.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace aligngs {

struct LeaseTimes {
  double renew_seconds = 5;   ///< between two touches: seldom enough for a network file system with a thousand rooms
  double stale_seconds = 60;  ///< untouched for so long: its holder is dead; above what a network file system may pause
};

/// State of the lease of a room.
struct LeaseView {
  int number = 0;    ///< 0: there is none
  std::string host;  ///< of its holder; empty where the file has no content yet
  int64_t pid = 0;
  int64_t touched = 0;     ///< nanoseconds, by the clock of the file system
  double age_seconds = 0;  ///< since the last touch
  bool stale = false;      ///< untouched for too long, or its holder ran on this machine and is gone

  bool held() const { return number > 0 && !stale; }
};

/// The lease of a room in a folder of leases; none where the folder is missing.
LeaseView look_at_lease(const std::filesystem::path& leases, const std::string& room, const LeaseTimes& times);

/// A held lease, touched by a thread of its own. Ends with its object, or with the process, after which others find it
/// stale.
class Lease {
 public:
  /// Nothing when somebody else holds it or was faster. Error{kResources} when the folder cannot be written.
  static std::optional<Lease> take(const std::filesystem::path& leases, const std::string& room,
                                   const LeaseTimes& times);

  Lease(Lease&&) noexcept;
  Lease& operator=(Lease&&) = delete;
  ~Lease();

  /// Whether somebody else found it stale and took it, as after a long pause of this machine: the room's work must end
  /// at once.
  bool lost() const;

 private:
  class Held;
  explicit Lease(std::unique_ptr<Held> held);

  std::unique_ptr<Held> held_;
};

/// Name of this machine, for leases and records.
std::string host_name();

}  // namespace aligngs
