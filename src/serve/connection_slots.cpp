#include "serve/connection_slots.h"

#include <algorithm>
#include <utility>

namespace aligngs {

ConnectionSlots::Slot::Slot(Slot&& other) noexcept
    : owner_(std::exchange(other.owner_, nullptr)), entry_(other.entry_) {}

ConnectionSlots::Slot::~Slot() {
  if (owner_ == nullptr) return;
  if (!entry_->closed) --owner_->open_;
  owner_->entries_.erase(entry_);
}

void ConnectionSlots::Slot::idle() {
  entry_->idle = true;
  owner_->entries_.splice(owner_->entries_.end(), owner_->entries_, entry_);
}

void ConnectionSlots::Slot::busy() { entry_->idle = false; }

std::optional<ConnectionSlots::Slot> ConnectionSlots::take(std::function<void()> close) {
  if (open_ >= most_) {
    const auto silent =
        std::find_if(entries_.begin(), entries_.end(), [](const Entry& e) { return e.idle && !e.closed; });
    if (silent == entries_.end()) return {};
    silent->closed = true;
    --open_;
    silent->close();
  }
  ++open_;
  entries_.push_back({std::move(close)});
  return std::optional<Slot>(std::in_place, *this, std::prev(entries_.end()));
}

}  // namespace aligngs
