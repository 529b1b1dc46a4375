// The folder of a batch. It is the whole state: any number of workers share it, also over a network file system.
//
//   list.json          the rooms, from LIST
//   rooms/NAME/        the run folder of a room
//   records/NAME.json  how its last attempt ended, and the digest of its inputs (room_record.h)
//   leases/NAME.N      present while a worker has the room (lease.h)
//   logs/NAME.txt      what its attempts wrote to standard error
#pragma once

#include <filesystem>
#include <vector>

#include "batch/room_list.h"

namespace aligngs {

struct Batch {
  std::filesystem::path list;    ///< absolute path of LIST
  std::vector<RoomEntry> rooms;  ///< in the order of LIST

  /// The folder to which relative sources and paths in options belong.
  std::filesystem::path base() const { return list.parent_path(); }
  /// Absolute path of a room's source; "demo" of a synthetic room.
  std::filesystem::path source_of(const RoomEntry& room) const;
  /// Error{kUsage} with names that are near, when there is no such room.
  const RoomEntry& room(const std::string& name) const;
};

class BatchFolder {
 public:
  explicit BatchFolder(const std::filesystem::path& folder);  ///< made absolute

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path list() const { return folder_ / "list.json"; }
  std::filesystem::path leases() const { return folder_ / "leases"; }
  std::filesystem::path run(const std::string& room) const { return folder_ / "rooms" / room; }
  std::filesystem::path record(const std::string& room) const { return folder_ / "records" / (room + ".json"); }
  std::filesystem::path log(const std::string& room) const { return folder_ / "logs" / (room + ".txt"); }
  /// Standard output of the last attempt: one JSON document.
  std::filesystem::path output(const std::string& room) const { return folder_ / "logs" / (room + ".json"); }

  /// Creates the folders and writes list.json where it differs. Error{kUsage} when the folder holds anything else than
  /// a batch.
  void prepare(const Batch& batch) const;
  /// Error{kUsage} when the folder holds no batch, Error{kBadInput} when list.json is damaged.
  Batch read() const;

 private:
  std::filesystem::path folder_;
};

}  // namespace aligngs
