#include "volume/brick_slots.hpp"

#include <algorithm>
#include <cassert>

namespace apeiron::volume {

std::size_t BrickSlots::pin(const BrickKey& key) {
    const auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.key; });
    assert(free != slots_.end());
    *free = {key, kPinned};
    const auto place = static_cast<std::size_t>(free - slots_.begin());
    places_[key] = place;
    return place;
}

void BrickSlots::want(const std::vector<BrickKey>& wanted) {
    ++now_;
    loads_.clear();
    done_ = 0;
    for (const BrickKey& key : wanted) {
        const auto found = places_.find(key);
        if (found == places_.end()) {
            loads_.push_back({key, 0});
        } else if (slots_[found->second].wanted != kPinned) {
            slots_[found->second].wanted = now_;
        }
    }
    // Free places first (they were wanted at time 0), then those that were wanted longest ago.
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < slots_.size(); ++i)
        if (slots_[i].wanted < now_) places.push_back(i);
    assert(loads_.size() <= places.size());
    std::stable_sort(places.begin(), places.end(),
                     [&](std::size_t a, std::size_t b) { return slots_[a].wanted < slots_[b].wanted; });
    for (std::size_t i = 0; i < loads_.size(); ++i) {
        Slot& slot = slots_[places[i]];
        if (slot.key) places_.erase(*slot.key);
        slot = {};
        loads_[i].slot = places[i];
    }
}

std::optional<BrickSlots::Next> BrickSlots::next() const {
    if (done_ == loads_.size()) return std::nullopt;
    return loads_[done_];
}

void BrickSlots::arrived() {
    assert(done_ < loads_.size());
    const Next& load = loads_[done_++];
    slots_[load.slot] = {load.key, now_};
    places_[load.key] = load.slot;
}

std::optional<std::size_t> BrickSlots::find(const BrickKey& key) const {
    const auto found = places_.find(key);
    if (found == places_.end()) return std::nullopt;
    return found->second;
}

} // namespace apeiron::volume
