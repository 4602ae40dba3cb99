#include "core/light/mesh_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/light/emitter_tree.h"
#include "core/light/triangle.h"

namespace relight {
namespace {

/// Twice the area, toward the front.
Vec3 normal_area(const Emitter& emitter)
{
    const auto& [a, b, c] = emitter.corners;
    return cross(b - a, c - a);
}

double area(const Emitter& emitter)
{
    return 0.5 * length(normal_area(emitter));
}

/// Luminance x area: its share of the table's flux, as the eye weighs it.
double weight(const Emitter& emitter)
{
    return luminance(emitter.L) * area(emitter);
}

bool is_in_front(const Emitter& emitter, Point3 p)
{
    return dot(normal_area(emitter), p - emitter.corners[0]) > 0.0;
}

}  // namespace

EmitterTable::EmitterTable(std::vector<Emitter> emitters) : emitters_(std::move(emitters))
{
    std::erase_if(emitters_,
                  [](const Emitter& e) { return !(weight(e) > 0.0) || !std::isfinite(weight(e)); });
    std::sort(emitters_.begin(), emitters_.end(),
              [](const Emitter& a, const Emitter& b) { return a.primitive < b.primitive; });
    double sum = 0.0;
    for (const Emitter& emitter : emitters_) {
        sum += weight(emitter);
        cdf_.push_back(sum);
        flux_ += emitter.L * (std::numbers::pi * area(emitter));
    }
    bounds_ = bounds_of(emitters_);
    const auto parts = static_cast<double>(cdf_.size());
    std::uint32_t i = 0;
    for (std::size_t part = 0; part < cdf_.size(); ++part) {
        const double t = static_cast<double>(part) / parts * sum;
        while (i + 1 < cdf_.size() && !(cdf_[i] > t)) { ++i; }
        guide_.push_back(i);
    }
}

EmitterTable::~EmitterTable() = default;

const Emitter& EmitterTable::drawn_by(double pick) const
{
    const double t = pick * cdf_.back();  // may round up to the whole sum
    const auto parts = static_cast<double>(cdf_.size());
    std::size_t i = guide_[static_cast<std::size_t>(std::min(pick * parts, parts - 1.0))];
    while (i > 0 && cdf_[i - 1] > t) { --i; }  // pick * parts may have been rounded up
    while (i + 1 < cdf_.size() && !(cdf_[i] > t)) { ++i; }
    return emitters_[i];
}

LightSample EmitterTable::sample(Point3 p, Sample2 s, double pick) const
{
    if (emitters_.empty()) { return {}; }
    const Emitter& emitter = drawn_by(pick);
    if (!is_in_front(emitter, p)) { return {}; }
    LightSample drawn = sample_triangle(emitter.corners, p, s);
    if (!drawn.wi) { return {}; }
    drawn.L = emitter.L;
    drawn.pdf *= weight(emitter) / cdf_.back();
    return drawn;
}

LightSample EmitterTable::look(std::uint32_t primitive, Point3 p, Dir3 wi) const
{
    const Emitter* emitter = find(primitive);
    return emitter != nullptr ? look(*emitter, p, wi) : LightSample{};
}

LightSample EmitterTable::look_along(Point3 origin, Point3 p, Dir3 wi) const
{
    std::call_once(is_planted_, [&] { tree_ = std::make_unique<const EmitterTree>(emitters_); });
    const auto met = tree_->nearest(origin, wi);
    return met ? look(emitters_[*met], p, wi) : LightSample{};
}

LightSample EmitterTable::look(const Emitter& emitter, Point3 p, Dir3 wi) const
{
    if (!is_in_front(emitter, p)) { return {}; }
    LightSample seen = look_at_triangle(emitter.corners, p, wi);
    if (!seen.wi) { return {}; }
    seen.L = emitter.L;
    seen.pdf *= weight(emitter) / cdf_.back();
    return seen;
}

Rgb EmitterTable::radiance(std::uint32_t primitive) const
{
    const Emitter* emitter = find(primitive);
    return emitter != nullptr ? emitter->L : Rgb{};
}

const Emitter* EmitterTable::find(std::uint32_t primitive) const
{
    const auto it = std::lower_bound(
        emitters_.begin(), emitters_.end(), primitive,
        [](const Emitter& e, std::uint32_t wanted) { return e.primitive < wanted; });
    return it != emitters_.end() && it->primitive == primitive ? &*it : nullptr;
}

}  // namespace relight
