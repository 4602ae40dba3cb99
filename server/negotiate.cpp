#include "server/negotiate.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <vector>

namespace relight {
namespace {

/// One element of an Accept list.
struct Accepted {
    std::string name;
    double q = 1.0;
};

std::string_view trimmed(std::string_view text)
{
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) { return {}; }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string lower(std::string_view text)
{
    std::string out(text);
    for (char& c : out) {
        if (c >= 'A' && c <= 'Z') { c = static_cast<char>(c - 'A' + 'a'); }
    }
    return out;
}

std::vector<std::string_view> split(std::string_view text, char at)
{
    std::vector<std::string_view> pieces;
    while (true) {
        const auto end = text.find(at);
        pieces.push_back(trimmed(text.substr(0, end)));
        if (end == std::string_view::npos) { return pieces; }
        text.remove_prefix(end + 1);
    }
}

std::vector<Accepted> accept_list(std::string_view header)
{
    std::vector<Accepted> list;
    for (const std::string_view element : split(header, ',')) {
        const auto pieces = split(element, ';');
        if (pieces[0].empty()) { continue; }
        Accepted accepted{lower(pieces[0])};
        for (std::size_t i = 1; i < pieces.size(); ++i) {
            const std::string parameter = lower(pieces[i]);
            if (!parameter.starts_with("q=")) { continue; }
            const char* end = parameter.data() + parameter.size();
            if (std::from_chars(parameter.data() + 2, end, accepted.q).ptr != end) {
                accepted.q = 0.0;
            }
        }
        list.push_back(std::move(accepted));
    }
    return list;
}

/// The types each format answers to, the one it is sent as first.
constexpr std::pair<Format, std::string_view> media_types[] = {
    {Format::Ply, "model/ply"},
    {Format::Ply, "application/octet-stream"},
    {Format::Json, "application/json"},
    {Format::Npz, "application/x-npz"},
    {Format::Png, "image/png"},
    {Format::Exr, "image/x-exr"},
    {Format::Npz, "application/zip"},
    {Format::Glb, "model/gltf-binary"},
    {Format::Obj, "model/obj"},
    {Format::Off, "model/off"},
    {Format::Vtp, "application/x-vtp"},
    {Format::Las, "application/vnd.las"},
    {Format::Jpeg, "image/jpeg"},
    {Format::Hdr, "image/vnd.radiance"},
    {Format::Fields, "application/octet-stream"}};  // after ply: Accept asks for that

bool matches(std::string_view range, std::string_view type)
{
    if (range == "*/*" || range == type) { return true; }
    return range.ends_with("/*") && type.starts_with(range.substr(0, range.size() - 1));
}

}  // namespace

std::string_view media_type(Format format)
{
    if (format == Format::PlyAscii) { format = Format::Ply; }
    return std::find_if(std::begin(media_types), std::end(media_types),
                        [&](const auto& entry) { return entry.first == format; })
        ->second;
}

std::optional<Format> format_accepted(std::string_view accept)
{
    const auto list = accept_list(accept);
    if (list.empty()) { return Format::Ply; }
    std::optional<Format> best;
    double best_q = 0.0;
    for (const auto& [format, type] : media_types) {
        // The most specific range that matches decides (RFC 9110).
        const Accepted* deciding = nullptr;
        for (const Accepted& accepted : list) {
            const auto rank = [](const Accepted& a) {
                return a.name == "*/*" ? 0 : a.name.ends_with("/*") ? 1 : 2;
            };
            if (matches(accepted.name, type) &&
                (deciding == nullptr || rank(accepted) > rank(*deciding))) {
                deciding = &accepted;
            }
        }
        if (deciding != nullptr && deciding->q > best_q) {
            best_q = deciding->q;
            best = format;
        }
    }
    return best;
}

bool accepts_gzip(std::string_view accept_encoding)
{
    double q = 0.0;
    for (const Accepted& accepted : accept_list(accept_encoding)) {
        if (accepted.name == "gzip" || accepted.name == "x-gzip") { return accepted.q > 0.0; }
        if (accepted.name == "*") { q = accepted.q; }
    }
    return q > 0.0;
}

std::string essence(std::string_view content_type)
{
    return lower(trimmed(content_type.substr(0, content_type.find(';'))));
}

}  // namespace relight
