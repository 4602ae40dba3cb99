#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>

#include "core/light/area.h"
#include "core/light/directional_light.h"
#include "core/light/environment.h"
#include "core/light/ies.h"
#include "core/light/mesh_light.h"
#include "core/light/point_light.h"
#include "core/light/sky.h"
#include "core/light/spot_light.h"

namespace relight {

/// What the light is. A new kind is a file here and a line in this variant.
using LightShape = std::variant<PointLight, SpotLight, DirectionalLight, IesLight, RectLight,
                                DiskLight, SphereLight, EnvironmentLight, SkyLight, MeshLight>;

/// A light of the request. The shape carries unit power; `power` says how much of it and in which
/// colour, so that a transport column (the shape's) outlives a change of power (a dot product).
struct Light {
    std::string name;
    LightShape shape;
    /// I [W/sr] or [cd] of point and spot; E_perp [W/m^2] or [lx] of directional; L [W/(m^2 sr)] or
    /// [cd/m^2] of rect, disk, sphere and constant environment; of the others a factor.
    Rgb power = Rgb::grey(1.0);
    bool enabled = true;
    bool cast_shadows = true;
};

/// One direction alone brings its light: point, spot, ies, and a sun without a disc.
bool is_delta(const LightShape& shape);

/// What one unit of a delta light brings to a receiver, unoccluded.
struct Arrival {
    Vec3 to_light;      ///< not unit; from the receiver to the light (or along it, if directional)
    double distance{};  ///< to the light, scene units; infinite for directional
    Dir3 wi;            ///< unit; "no direction" where the light is at the receiver
    double per_unit{};  ///< E facing wi from unit power, cone included: 1/d^2 [sr/m^2], or 1
};

/// Unoccluded arrival of one unit of a delta light at p. E = power * per_unit * (n . wi)+.
Arrival arrive(const LightShape& shape, Point3 p);

/// The faces as a place sees them.
struct MeshView {
    const EmitterTable* table;
    Point3 p;

    LightSample sample(Sample2 s, double pick) const { return table->sample(p, s, pick); }
};

/// What depends on the place alone of drawing a light that is no delta: made once for a place, from
/// which many directions are drawn. Delta lights show nothing. The light outlives it.
using LightView = std::variant<std::monostate, RectView, DiskView, SphereView, SunView,
                               EnvironmentView, SkyView, MeshView>;
LightView view(const LightShape& shape, Point3 p);
LightSample sample(const LightView& view, Sample2 s, double pick);
LightSample look(const LightView& view, Dir3 wi);

/// A direction toward a light that is no delta, and what it shows there. `pick` chooses between
/// parts (sun or dome, which triangle); s is then uniform still.
LightSample sample(const LightShape& shape, Point3 p, Sample2 s, double pick);

/// What such a light shows along wi, and the density with which sample() draws it. Not for
/// MeshLight: what of it is seen depends on the mesh in between (EmitterTable::look).
LightSample look(const LightShape& shape, Point3 p, Dir3 wi);

/// E facing n from unit power of such a light, unoccluded, where a closed form is known: rect,
/// disk, sphere, sun, constant sky.
std::optional<double> closed_irradiance(const LightShape& shape, Point3 p, Dir3 n);

/// The same at many places; 0 where no closed form is known. Of rectangles in vectors.
void closed_irradiance(const LightShape& shape, std::span<const Point3> p, std::span<const Dir3> n,
                       std::span<double> E);

/// Its light has one colour everywhere: columns of one band do.
bool is_grey(const LightShape& shape);

}  // namespace relight
