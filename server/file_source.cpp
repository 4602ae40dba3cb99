#include "server/file_source.h"

#include "server/json_text.h"

namespace relight {
namespace {

constexpr std::size_t id_digits = 64;
constexpr std::size_t longest_part_name = 128;

bool is_id(std::string_view text)
{
    return text.size() == id_digits &&
           text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace

std::optional<std::variant<StoredMesh, PartMesh>> parse_file_source(Fields& fields,
                                                                    std::string_view route)
{
    const bool stored = fields.has("id");
    const bool sent = fields.has("part");
    if (!stored && !sent) { return {}; }
    if (stored && sent) {
        fields.fail(Fault::ConflictingFields, "part",
                    "\"id\" is given too; a file is one or the other: stored (id) or sent along "
                    "(part)");
    }
    std::variant<StoredMesh, PartMesh> source;
    if (stored) {
        const std::string id = fields.text("id", id_digits).value_or("");
        if (!is_id(id)) {
            fields.fail(Fault::UnknownValue, "id",
                        "found \"" + printable(id, 80) +
                            "\"; an id is the 64 lower-case hex digits that " + std::string(route) +
                            " answered");
        }
        source = StoredMesh{id};
    } else {
        source = PartMesh{fields.text("part", longest_part_name).value_or("")};
    }
    fields.finish();
    return source;
}

}  // namespace relight
