#pragma once

#include "volume/bricked.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace apeiron::volume {

/// Which brick is in which place of a memory of fixed size: of what is not wanted, the one that was wanted least
/// recently gives its place away first.
class BrickSlots {
  public:
    explicit BrickSlots(std::size_t slots) : slots_(slots) {}

    /// Puts a brick into a free place for ever. @pre there is one @returns the place
    std::size_t pin(const BrickKey& key);

    /// From now on these bricks are wanted, the most urgent first; earlier wishes are forgotten. What has to give its
    /// place away for them is gone at once. @pre no more than there are places without a pinned brick
    void want(const std::vector<BrickKey>& wanted);

    /// The most urgent brick that is wanted and not there, and its place; nothing when all are there.
    struct Next {
        BrickKey key;
        std::size_t slot = 0;
    };
    std::optional<Next> next() const;
    /// It is there now. @pre next()
    void arrived();

    /// The place of a brick; nothing where it is not there.
    std::optional<std::size_t> find(const BrickKey& key) const;

    std::size_t size() const { return slots_.size(); }
    std::size_t used() const { return places_.size(); }
    std::size_t missing() const { return loads_.size() - done_; }

  private:
    struct Slot {
        std::optional<BrickKey> key;
        std::uint64_t wanted = 0; ///< when it was last
    };
    static constexpr std::uint64_t kPinned = ~std::uint64_t{0};

    std::vector<Slot> slots_;
    std::map<BrickKey, std::size_t> places_;
    std::vector<Next> loads_; ///< of the present wishes
    std::size_t done_ = 0;    ///< of these
    std::uint64_t now_ = 0;
};

} // namespace apeiron::volume
