#include "core/io/ply_header.h"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_set>

#include "core/io/text_scanner.h"

namespace relight::ply {
namespace {

constexpr std::array<std::string_view, 8> short_names = {"char", "uchar", "short", "ushort",
                                                         "int",  "uint",  "float", "double"};
constexpr std::array<std::string_view, 8> sized_names = {"int8",  "uint8",  "int16",   "uint16",
                                                         "int32", "uint32", "float32", "float64"};

std::optional<Scalar> scalar_named(std::string_view name)
{
    for (std::size_t i = 0; i < short_names.size(); ++i) {
        if (name == short_names[i] || name == sized_names[i]) { return static_cast<Scalar>(i); }
    }
    return {};
}

Error unknown_type(const TextScanner& scanner, std::string_view word)
{
    return scanner.error(Fault::MalformedHeader,
                         "property type " + shown(word) +
                             " is not one of char, uchar, short, ushort, int, uint, float, double "
                             "or int8, uint8, int16, uint16, int32, uint32, float32, float64");
}

Result<Encoding> read_format(TextScanner& scanner)
{
    const std::string_view name = scanner.word();
    const std::string_view version = scanner.word();
    if (version != "1.0") {
        return scanner.error(Fault::MalformedHeader,
                             "PLY version " + shown(version) + " is not known; 1.0 is");
    }
    if (name == "ascii") { return Encoding::Ascii; }
    if (name == "binary_little_endian") { return Encoding::BinaryLittleEndian; }
    if (name == "binary_big_endian") { return Encoding::BinaryBigEndian; }
    return scanner.error(
        Fault::MalformedHeader,
        "format " + shown(name) + " is not ascii, binary_little_endian or binary_big_endian");
}

Result<Element> read_element(TextScanner& scanner)
{
    Element element;
    element.name = scanner.word();
    const std::string_view word = scanner.word();
    const Number<std::int64_t> count = parse_integer(word);
    if (!count || count.value < 0) {
        return scanner.error(Fault::MalformedHeader,
                             "element " + shown(element.name) + " announces " + shown(word) +
                                 " records; a whole number from 0 is needed");
    }
    element.count = static_cast<std::uint64_t>(count.value);
    return element;
}

Result<Property> read_property(TextScanner& scanner)
{
    Property property;
    std::string_view type = scanner.word();
    if (type == "list") {
        const std::string_view count = scanner.word();
        property.count = scalar_named(count);
        if (!property.count) { return unknown_type(scanner, count); }
        if (!is_integer(*property.count)) {
            return scanner.error(
                Fault::MalformedHeader,
                "a list's length has type " + shown(count) + "; an integer type is needed");
        }
        type = scanner.word();
    }
    const std::optional<Scalar> scalar = scalar_named(type);
    if (!scalar) { return unknown_type(scanner, type); }
    property.type = *scalar;
    property.name = scanner.word();
    if (property.name.empty()) {
        return scanner.error(Fault::MalformedHeader, "a property has no name");
    }
    return property;
}

/// Collects the header line by line; what it holds is true of the lines so far.
struct HeaderReader {
    Header header;
    bool has_format = false;
    std::unordered_set<std::string_view> elements, properties;  // names, to find one given twice

    Result<Done> add_element(TextScanner& scanner)
    {
        Result<Element> element = read_element(scanner);
        if (!element) { return std::move(element).error(); }
        if (!elements.insert(element->name).second) {
            return scanner.error(Fault::MalformedHeader,
                                 "element " + shown(element->name) + " is announced twice");
        }
        properties = {};  // clear() would cost the largest element once per element
        header.elements.push_back(std::move(*element));
        return Done{};
    }

    Result<Done> add_property(TextScanner& scanner)
    {
        const Result<Property> property = read_property(scanner);
        if (!property) { return property.error(); }
        if (header.elements.empty()) {
            return scanner.error(Fault::MalformedHeader, "a property stands before any element");
        }
        if (!properties.insert(property->name).second) {
            return scanner.error(Fault::MalformedHeader,
                                 "property " + shown(property->name) + " is given twice");
        }
        header.elements.back().properties.push_back(*property);
        return Done{};
    }

    Result<Done> set_format(TextScanner& scanner)
    {
        if (has_format) { return scanner.error(Fault::MalformedHeader, "a second format line"); }
        has_format = true;
        return read_format(scanner).transform([&](Encoding encoding) {
            header.encoding = encoding;
            return Done{};
        });
    }

    Result<Done> read_line(std::string_view keyword, TextScanner& scanner)
    {
        if (keyword == "format") { return set_format(scanner); }
        if (keyword == "element") { return add_element(scanner); }
        if (keyword == "property") { return add_property(scanner); }
        return scanner.error(Fault::MalformedHeader,
                             "header line starts with " + shown(keyword) +
                                 "; format, element, property, comment, obj_info or end_header "
                                 "is needed");
    }
};

}  // namespace

std::string_view name_of(Scalar type)
{
    return short_names[static_cast<std::size_t>(type)];
}

std::optional<std::size_t> Element::find(std::string_view wanted) const
{
    const auto it = std::find_if(properties.begin(), properties.end(),
                                 [&](const Property& p) { return p.name == wanted; });
    if (it == properties.end()) { return {}; }
    return static_cast<std::size_t>(it - properties.begin());
}

std::optional<std::size_t> Element::stride() const
{
    std::size_t bytes = 0;
    for (const Property& property : properties) {
        if (property.count) { return {}; }
        bytes += size_of(property.type);
    }
    return bytes;
}

const Element* Header::find(std::string_view wanted) const
{
    const auto it = std::find_if(elements.begin(), elements.end(),
                                 [&](const Element& e) { return e.name == wanted; });
    return it == elements.end() ? nullptr : &*it;
}

Result<Header> read_header(std::span<const std::byte> file)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    TextScanner scanner(file.first(std::min(file.size(), longest_header)));
    if (scanner.word() != "ply" || !scanner.at_line_end()) {
        return scanner.error(Fault::MalformedHeader, "a PLY file starts with a line 'ply'");
    }
    // After a header whose lines end with CR alone, a line feed is the body's first byte.
    const std::size_t first_end = scanner.offset();
    scanner.next_line();
    const bool lone_cr = scanner.offset() == first_end + 1 && file[first_end] == std::byte{'\r'};

    HeaderReader reader;
    for (; !scanner.at_end(); scanner.next_line()) {
        const std::string_view keyword = scanner.word();
        if (keyword.empty() || keyword == "comment" || keyword == "obj_info") { continue; }
        if (keyword != "end_header") {
            const Result<Done> read = reader.read_line(keyword, scanner);
            if (!read) { return read.error(); }
        }
        if (!scanner.at_line_end()) {
            return scanner.error(Fault::MalformedHeader,
                                 "the line does not end after its last word, but goes on with " +
                                     shown(scanner.word()));
        }
        if (keyword != "end_header") { continue; }
        if (!reader.has_format) {
            return scanner.error(Fault::MalformedHeader, "the header has no format line");
        }
        const std::size_t end = scanner.offset();
        scanner.next_line();
        reader.header.body = lone_cr ? std::min(end + 1, scanner.offset()) : scanner.offset();
        reader.header.body_line = scanner.line();
        return std::move(reader.header);
    }
    return scanner.error(Fault::MalformedHeader,
                         file.size() > longest_header
                             ? "the header has no end_header within its first MiB"
                             : "the file ends before the header's end_header line");
}

}  // namespace relight::ply
