#include "render/governor.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace apeiron::render {

std::int64_t Governor::next(double remaining, bool mustWork) const {
    if (remaining <= 0.0) return mustWork ? 1 : 0;
    std::int64_t pixels = limit_;
    if (cost_ > 0.0) {
        // Costs vary over a picture: plan for 1.5 times what was seen.
        const double affordable = (std::min(remaining, kMaxSubmission) - overhead_) / (1.5 * cost_);
        // The rest of a step is not worth a submission whose fixed cost outweighs its work.
        if (!mustWork && affordable * cost_ < overhead_) return 0;
        pixels = std::min(pixels, static_cast<std::int64_t>(std::clamp(affordable, 0.0, 1e15)));
    }
    return mustWork ? std::max<std::int64_t>(pixels, 1) : pixels;
}

void Governor::report(std::int64_t pixels, double seconds) {
    if (pixels <= 0) return;
    // What the smallest submissions take is the fixed cost of any.
    overhead_ = overhead_ == 0.0 ? std::min(0.5 * seconds, 1e-3) : std::min(overhead_, seconds);
    const double cost = std::max(seconds - overhead_, 0.1 * seconds) / static_cast<double>(pixels);
    // Up at once, as the next tile may be an expensive one too, unless it was too small to say much; down slowly.
    const bool telling = pixels >= kFirstPixels || seconds > std::max(2e-3, 5.0 * overhead_);
    if (cost_ == 0.0 || (cost > cost_ && telling)) {
        cost_ = cost;
    } else if (cost < cost_) {
        cost_ = 0.75 * cost_ + 0.25 * cost;
    }
    if (seconds > kMaxSubmission) {
        limit_ = std::max<std::int64_t>(pixels / 2, 1);
    } else if (2 * pixels > limit_) {
        // (Whole rows: what was submitted is seldom exactly the limit.)
        limit_ = std::min<std::int64_t>(limit_ * 4, std::int64_t{1} << 40);
    }
}

void Governor::restart() {
    *this = Governor();
}

int TileCursor::fresh() const {
    const std::int64_t band = static_cast<std::int64_t>(size_.x) * kBand;
    const std::int64_t begun = (index() + band - 1) / band * kBand;
    return begun < size_.y ? static_cast<int>(begun) : 0;
}

gpu::Region TileCursor::take(std::int64_t texels) {
    assert(!done() && texels >= 1);
    const std::int64_t width = size_.x;
    const int top = static_cast<int>(index() / (width * kBand)) * kBand;
    const std::int64_t rows = std::min(kBand, size_.y - top);
    const std::int64_t inside = index() - top * width;
    const auto x = static_cast<int>(inside / rows);
    const auto y = static_cast<int>(inside % rows);
    gpu::Region region{{x, top + y}, {1, 1}};
    if (y > 0 || texels < rows) {
        region.size.y = static_cast<int>(std::min(texels, rows - y));
    } else if (x > 0 || texels < width * rows) {
        std::int64_t columns = std::min(texels / rows, width - x);
        if (columns > kBand && x + columns < width) columns = columns / kBand * kBand;
        region.size = {static_cast<int>(columns), static_cast<int>(rows)};
    } else {
        // Not beyond the last row, nor into those that were the first.
        const std::int64_t most = std::min<std::int64_t>(size_.y - top, left() / width);
        std::int64_t whole = std::min(texels / width, most);
        if (whole < most) whole = whole / kBand * kBand;
        region.size = {size_.x, static_cast<int>(whole)};
    }
    next_ += static_cast<std::int64_t>(region.size.x) * region.size.y;
    return region;
}

} // namespace apeiron::render
