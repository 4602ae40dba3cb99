// The file's materials: factors of MetallicRoughness, and the textures that vary them.
#include "server/import/gltf_look.h"

#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "server/import/gltf_factors.h"
#include "server/import/gltf_images.h"

namespace relight::gltf {
namespace {

struct PassedOver {
    std::string_view extension, note;
};

/// Extensions of a material that change how it looks and that we do not have.
constexpr PassedOver passed_over[] = {
    {"KHR_materials_unlit", "KHR_materials_unlit is passed over: such surfaces are lit too"},
    {"KHR_materials_pbrSpecularGlossiness",
     "KHR_materials_pbrSpecularGlossiness is passed over: pbrMetallicRoughness is taken"},
    {"KHR_materials_transmission",
     "KHR_materials_transmission is passed over: surfaces are opaque"},
    {"KHR_materials_diffuse_transmission",
     "KHR_materials_diffuse_transmission is passed over: surfaces are opaque"},
    {"KHR_materials_volume", "KHR_materials_volume is passed over: surfaces are opaque"},
    {"KHR_materials_dispersion", "KHR_materials_dispersion is passed over: surfaces are opaque"},
    {"KHR_materials_iridescence",
     "KHR_materials_iridescence is passed over: reflections keep their colour"},
};

double share(const Node& node, std::string_view key, double otherwise)
{
    return node.number(key, otherwise, 0.0, 1.0);
}

/// One material, factors and textures.
class MaterialReader {
  public:
    MaterialReader(Node material, Pictures& pictures, Notes& notes)
        : material_(std::move(material)), pictures_(&pictures), notes_(&notes)
    {
        read_base();
        read_dielectric();
        read_layers();
        read_anisotropy();
        read_emission();
        note_the_rest();
    }

    const MetallicRoughness& factors() const { return factors_; }
    const MaterialMaps& maps() const { return maps_; }

  private:
    void read_base()
    {
        if (const auto pbr = material_.find("pbrMetallicRoughness")) {
            // The fourth, coverage, is passed over with alphaMode.
            if (const auto base = gltf::factors(*pbr, "baseColorFactor", 4, 0.0, 1.0)) {
                factors_.base_color = {(*base)[0], (*base)[1], (*base)[2]};
            }
            factors_.metallic = share(*pbr, "metallicFactor", 1.0);
            factors_.roughness = share(*pbr, "roughnessFactor", 1.0);
            maps_.base_color = pictures_->map(*pbr, "baseColorTexture");
            maps_.metallic_roughness = pictures_->map(*pbr, "metallicRoughnessTexture");
        }
        maps_.base_color_factor = factors_.base_color;
        if (const auto normal = material_.find("normalTexture")) {
            maps_.normal = pictures_->map(material_, "normalTexture");
            maps_.normal_scale =
                static_cast<float>(normal->number("scale", 1.0, -largest_factor, largest_factor));
        }
    }

    void read_dielectric()
    {
        if (const auto ior = material_.extension("KHR_materials_ior")) {
            factors_.ior = ior->number("ior", 1.5, 0.0, largest_factor);
            if (factors_.ior > 0.0 && factors_.ior < 1.0) {
                refuse(Fault::OutOfRange, ior->where() + "/ior",
                       "lies between 0 and 1, and must be 1 or more, or 0 for a surface that "
                       "reflects all");
            }
        }
        if (const auto specular = material_.extension("KHR_materials_specular")) {
            factors_.specular = share(*specular, "specularFactor", 1.0);
            factors_.specular_color =
                color(*specular, "specularColorFactor", Rgb::grey(1.0), largest_factor);
            maps_.specular = pictures_->map(*specular, "specularTexture");
            maps_.specular_color = pictures_->map(*specular, "specularColorTexture");
        }
    }

    void read_layers()
    {
        if (const auto coat = material_.extension("KHR_materials_clearcoat")) {
            factors_.clearcoat = share(*coat, "clearcoatFactor", 0.0);
            factors_.clearcoat_roughness = share(*coat, "clearcoatRoughnessFactor", 0.0);
            maps_.clearcoat = pictures_->map(*coat, "clearcoatTexture");
            maps_.clearcoat_roughness = pictures_->map(*coat, "clearcoatRoughnessTexture");
            if (coat->has("clearcoatNormalTexture")) {
                notes_->add(
                    "clearcoatNormalTexture is passed over: the coat has the base's normal");
            }
        }
        if (const auto sheen = material_.extension("KHR_materials_sheen")) {
            factors_.sheen_color = color(*sheen, "sheenColorFactor", Rgb{});
            factors_.sheen_roughness = share(*sheen, "sheenRoughnessFactor", 0.0);
            maps_.sheen_color = pictures_->map(*sheen, "sheenColorTexture");
            maps_.sheen_roughness = pictures_->map(*sheen, "sheenRoughnessTexture");
        }
    }

    void read_anisotropy()
    {
        if (const auto brushed = material_.extension("KHR_materials_anisotropy")) {
            const double rotation =
                brushed->number("anisotropyRotation", 0.0, -largest_factor, largest_factor);
            factors_.anisotropy_strength = share(*brushed, "anisotropyStrength", 0.0);
            factors_.anisotropy_rotation = std::remainder(rotation, 2.0 * std::numbers::pi);
            maps_.anisotropy = pictures_->map(*brushed, "anisotropyTexture");
        }
    }

    void read_emission()
    {
        factors_.emissive = color(material_, "emissiveFactor", Rgb{});
        maps_.emissive = pictures_->map(material_, "emissiveTexture");
        if (const auto strength = material_.extension("KHR_materials_emissive_strength")) {
            factors_.emissive_strength =
                strength->number("emissiveStrength", 1.0, 0.0, largest_factor);
        }
    }

    void note_the_rest()
    {
        if (material_.has("occlusionTexture")) {
            notes_->add("occlusionTexture is passed over: occlusion is computed");
        }
        const std::string alpha = material_.text("alphaMode", "OPAQUE");
        if (alpha == "MASK" || alpha == "BLEND") {
            notes_->add("alphaMode " + alpha + " is passed over: surfaces are opaque");
        } else if (alpha != "OPAQUE") {
            refuse(Fault::MalformedBody, material_.where() + "/alphaMode",
                   "is " + shown(alpha) + ", and must be OPAQUE, MASK or BLEND");
        }
        if (material_.flag("doubleSided", false)) {
            notes_->add(
                "doubleSided: light is counted on the front alone unless the request sets "
                "transport.two_sided");
        }
        for (const PassedOver& each : passed_over) {
            if (material_.extension(each.extension)) { notes_->add(each.note); }
        }
    }

    Node material_;
    Pictures* pictures_;
    Notes* notes_;
    MetallicRoughness factors_;
    MaterialMaps maps_;
};

/// Names made unique by "_2", "_3" …: requests choose materials by them.
class Names {
  public:
    std::string unique(std::string name)
    {
        const auto [known, is_new] = times_.try_emplace(name, 1);
        if (is_new) { return name; }
        std::string numbered;
        std::size_t& times = known->second;  // try_emplace() moves no element
        do {
            numbered = name + '_' + std::to_string(++times);
        } while (!times_.try_emplace(numbered, 1).second);
        return numbered;
    }

  private:
    std::unordered_map<std::string, std::size_t> times_;  ///< that a name was asked for
};

/// What the rest of the file says about its look, beyond the materials.
void note_the_scene(const Node& root, Notes& notes)
{
    if (root.extension("KHR_materials_variants")) {
        notes.add("KHR_materials_variants is passed over: the first look is taken");
    }
}

}  // namespace

Look read_look(File& file, std::uint64_t most_pixels)
{
    Notes notes;
    Pictures pictures(file, most_pixels, notes);
    Names names;
    Look look;
    const Node root = file.root();
    const std::size_t count = root.size("materials");
    for (std::size_t i = 0; i < count; ++i) {
        const Node material = root.item("materials", i);
        const MaterialReader read(material, pictures, notes);
        const std::string name = material.text("name");
        look.names.push_back(names.unique(name.empty() ? "material_" + std::to_string(i) : name));
        look.materials.push_back(read.factors());
        look.maps.push_back(read.maps());
    }
    note_the_scene(root, notes);
    look.textures = pictures.take();
    look.notes = notes.take();
    return look;
}

}  // namespace relight::gltf
