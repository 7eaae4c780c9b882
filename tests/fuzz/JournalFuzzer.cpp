// SPDX-License-Identifier: MIT
// A journal, followed on a fixed cloud: each entry changes what it says (docs/dev/journal.md, "What an entry may
// change") and every other bit stays; one that cannot be followed changes nothing; undo leads back to each state
// before, and in the end to the first one, bit for bit.
//
// The first byte of the input: 1 the rest is a whole file (else lines without their sums, which are added, after
// the two that a journal of this cloud begins with); 2 the cloud has narrow classes and odd attributes (else it is
// a sample of point format 7); 4 the history packs what it keeps; 8 it moves it to a file.
#include "core/SummedText.h"
#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/edit/Literal.h"
#include "core/expression/Rule.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "tests/fuzz/FixedCloud.h"
#include "tests/fuzz/Fuzz.h"

#include <array>
#include <cstring>
#include <map>
#include <optional>

using namespace punctum;
using fuzz::promise;

namespace
{

constexpr PointIndex kPoints = fuzz::kPoints;
constexpr std::size_t kMostEntries = 40;

// -- what it is

/// All of a cloud that an edit could change.
struct State {
    struct Shown {
        Attribute attribute;                      ///< without its columns
        std::array<std::ptrdiff_t, 3> columns{};  ///< their places among those of the cloud; -1: none
    };
    std::vector<const Column*> identities;  ///< not compared
    std::vector<std::string> columnNames;
    std::vector<std::pair<int, std::uint32_t>> columnTypes;
    std::vector<std::vector<std::byte>> bytes;
    std::vector<Shown> attributes;
    PointSet deleted;

    const Shown* find(const std::string& name) const
    {
        for (const Shown& one : attributes)
            if (one.attribute.name == name) return &one;
        return nullptr;
    }
};

bool sameForm(const Attribute& a, const Attribute& b)
{
    return a.kind == b.kind && a.components == b.components && a.bitShift == b.bitShift &&
           a.bitWidth == b.bitWidth && a.scaled == b.scaled &&
           std::memcmp(&a.scale, &b.scale, sizeof a.scale) == 0 &&
           std::memcmp(&a.offset, &b.offset, sizeof a.offset) == 0 &&
           a.noData.has_value() == b.noData.has_value() && (!a.noData || toText(*a.noData) == toText(*b.noData)) &&
           a.standard == b.standard && a.unit == b.unit && a.description == b.description;
}

State stateOf(const PointCloud& cloud)
{
    State state;
    for (const auto& column : cloud.columns()) {
        state.identities.push_back(column.get());
        state.columnNames.push_back(column->name());
        state.columnTypes.emplace_back(int(column->type()), column->components());
        state.bytes.emplace_back(column->data(), column->data() + column->size() * column->elementBytes());
    }
    for (const Attribute& a : cloud.attributes()) {
        State::Shown shown{a, {-1, -1, -1}};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& all = cloud.columns();
            const auto at = std::find(all.begin(), all.end(), a.columns[c]);
            promise(a.columns[c] == nullptr || at != all.end(), "an attribute shows columns of the cloud");
            if (a.columns[c]) shown.columns[c] = at - all.begin();
            shown.attribute.columns[c].reset();
        }
        promise(state.find(a.name) == nullptr, "no two attributes have one name");
        state.attributes.push_back(std::move(shown));
    }
    state.deleted = cloud.deleted() ? *cloud.deleted() : PointSet(cloud.size());
    return state;
}

bool equal(const State& a, const State& b)
{
    const auto sameShown = [](const State::Shown& x, const State::Shown& y) {
        return x.attribute.name == y.attribute.name && sameForm(x.attribute, y.attribute) && x.columns == y.columns;
    };
    return a.columnNames == b.columnNames && a.columnTypes == b.columnTypes && a.bytes == b.bytes &&
           std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(),
                      sameShown) &&
           a.deleted == b.deleted;
}

// -- what an entry says

/// Attributes whose values, form or place in the list may change; true: of all points, whatever the entry's set.
using Names = std::map<std::string, bool>;

struct Claim {
    Names attributes;
    bool deletes = false;
    PointSet points{kPoints};  ///< of which values may change, or which may be deleted or restored
    PointIndex most = 0;       ///< how many of them
};

std::string valueOf(const Recipe& recipe, const char* key)
{
    const auto found = recipe.values.find(key);
    return found == recipe.values.end() ? std::string() : found->second;
}

/// The attribute, and those that show one of its columns: they go with it.
void addWithSharers(Names& names, const State& before, const std::string& name)
{
    names[name] = true;
    const State::Shown* const gone = before.find(name);
    if (gone == nullptr) return;
    for (const State::Shown& other : before.attributes)
        for (const std::ptrdiff_t column : gone->columns)
            if (column >= 0 && std::find(other.columns.begin(), other.columns.end(), column) != other.columns.end())
                names[other.attribute.name] = true;
}

Claim claimOf(const JournalEntry& entry, const State& before)
{
    Claim claim;
    claim.most = entry.changed;
    if (entry.within)
        claim.points = entry.within->unpacked();
    else
        claim.points.invert();
    const Recipe& recipe = entry.recipe;
    Names& names = claim.attributes;
    if (recipe.step == "normals") {
        names = {{"NormalX", true}, {"NormalY", true}, {"NormalZ", true}, {"Normal", true}, {"Curvature", true}};
    } else if (recipe.step == "features") {
        names = {{"Linearity", true},    {"Planarity", true}, {"Sphericity", true},
                 {"Anisotropy", true},   {"Curvature", true}, {"Verticality", true},
                 {"Omnivariance", true}, {"Roughness", true}, {"Density", true}};
    } else if (recipe.step == "splat-radius") {
        names = {{"SplatRadius", true}};
    } else if (recipe.step == "clusters") {
        names = {{"ClusterId", true}};
    } else if (recipe.step == "planes") {
        names = {{"PlaneId", true}};
    } else if (recipe.step == "outliers" || recipe.step == "radius-outliers" || recipe.step == "ground" ||
               recipe.step == "reclassify") {
        names = {{"Classification", false}};
    } else if (recipe.step == "buildings" || recipe.step == "vegetation") {
        names = {{"Classification", false}};
    } else if (recipe.step == "isolated" || recipe.step == "low" || recipe.step == "strays" ||
               recipe.step == "duplicates" || recipe.step == "thin" || recipe.step == "thin-to") {
        names = {{"Classification", false}, {"Withheld", false}, {"Kept", true}};
        claim.deletes = true;
    } else if (recipe.step == "height") {
        names = {{"HeightAboveGround", true}};
    } else if (recipe.step == "trees") {
        names = {{"TreeId", true}};
    } else if (recipe.step == "set") {
        names = {{expression::Rule(valueOf(recipe, "rule")).target(), !valueOf(recipe, "new").empty()}};
    } else if (recipe.step == "delete" || recipe.step == "restore") {
        claim.deletes = true;
    } else if (recipe.step == "rename") {
        names = {{valueOf(recipe, "attribute"), true}, {valueOf(recipe, "to"), true}};
    } else if (recipe.step == "remove") {
        addWithSharers(names, before, valueOf(recipe, "attribute"));
    } else if (recipe.step == kLiteralStep) {
        for (const auto& [key, text] : recipe.values) {
            const std::string rest = key.empty() ? key : key.substr(1);
            if (key.starts_with('-')) addWithSharers(names, before, rest);
            if (key.starts_with('>')) names[rest] = names[text] = true;
            if (key.starts_with('=')) names.emplace(rest, false);
            if (key.starts_with('+')) addWithSharers(names, before, text.substr(0, text.find('\n')));
            if (key == "deleted") claim.deletes = true;
        }
        // what comes, goes or gets a name is told for all points
        const bool lists = std::any_of(recipe.values.begin(), recipe.values.end(), [](const auto& value) {
            return value.first.starts_with('+') || value.first.starts_with('-') || value.first.starts_with('>');
        });
        if (lists) claim.most = kPoints;
    } else {
        promise(false, "every step that can be followed has its claim here");
    }
    return claim;
}

// -- whether it is kept

/// The bits of a column's element that an attribute shows; all of wider elements.
std::uint64_t bitsOf(const Attribute& a)
{
    return a.bitWidth == 0 ? ~std::uint64_t(0) : ((std::uint64_t(1) << a.bitWidth) - 1) << a.bitShift;
}

/// What an attribute of one component shows of a point.
std::vector<std::byte> shownAt(const State& state, const State::Shown& shown, PointIndex i)
{
    const std::vector<std::byte>& column = state.bytes[std::size_t(shown.columns[0])];
    const std::size_t bytes = column.size() / kPoints;
    std::vector<std::byte> element(column.begin() + std::ptrdiff_t(i * bytes),
                                   column.begin() + std::ptrdiff_t((i + 1) * bytes));
    if (shown.attribute.bitWidth != 0) {
        std::uint64_t v = 0;
        std::memcpy(&v, element.data(), bytes);
        v = (v & bitsOf(shown.attribute)) >> shown.attribute.bitShift;
        element.assign(sizeof v, std::byte(0));
        std::memcpy(element.data(), &v, sizeof v);
    }
    return element;
}

void checkAttributes(const State& before, const State& after, const Claim& claim)
{
    for (const State::Shown& was : before.attributes) {
        const std::string& name = was.attribute.name;
        const bool claimed = claim.attributes.contains(name);
        const State::Shown* const is = after.find(name);
        promise(is != nullptr || claimed, "only an attribute that is named goes");
        promise(is != nullptr || !was.attribute.standard, "fields of the point format stay");
        if (is == nullptr || claimed) continue;
        promise(sameForm(was.attribute, is->attribute), "an attribute that is not named keeps its form");
        if (was.attribute.components != 1) continue;  // what it shows is looked at by itself
        for (PointIndex i = 0; i < kPoints; ++i)
            promise(shownAt(before, was, i) == shownAt(after, *is, i),
                    "an attribute that is not named keeps its values");
    }
    for (const State::Shown& is : after.attributes)
        promise(before.find(is.attribute.name) != nullptr || claim.attributes.contains(is.attribute.name),
                "only an attribute that is named comes");
}

void checkColumns(const State& before, const State& after, const Claim& claim)
{
    PointSet differ(kPoints);
    for (std::size_t b = 0; b < before.bytes.size(); ++b) {
        const auto at = std::find(after.identities.begin(), after.identities.end(), before.identities[b]);
        if (at == after.identities.end()) continue;  // it went with an attribute, which has been looked at
        const auto a = std::size_t(at - after.identities.begin());
        std::uint64_t may = 0, mayEverywhere = 0;  // bits that named attributes show
        for (const State* state : {&before, &after})
            for (const State::Shown& shown : state->attributes)
                for (const std::ptrdiff_t c : shown.columns) {
                    const auto named = claim.attributes.find(shown.attribute.name);
                    if (c != std::ptrdiff_t(state == &before ? b : a) || named == claim.attributes.end()) continue;
                    may |= bitsOf(shown.attribute);
                    if (named->second) mayEverywhere |= bitsOf(shown.attribute);
                }
        const std::size_t bytes = before.bytes[b].size() / kPoints;
        for (PointIndex i = 0; i < kPoints; ++i) {
            const std::byte *x = before.bytes[b].data() + i * bytes, *y = after.bytes[a].data() + i * bytes;
            if (std::memcmp(x, y, bytes) == 0) continue;
            differ.insert(i);
            promise(b > 2, "coordinates stay as they are");
            std::uint64_t was = 0, is = 0;
            std::memcpy(&was, x, std::min(bytes, sizeof was));
            std::memcpy(&is, y, std::min(bytes, sizeof is));
            promise(((was ^ is) & ~may) == 0, "only bits of attributes that are named change");
            promise(bytes <= sizeof was || may == ~std::uint64_t(0), "only columns that are named change");
            promise(claim.points.contains(i) || ((was ^ is) & ~mayEverywhere) == 0,
                    "only points that are named change");
        }
    }
    promise(differ.count() <= claim.most, "no more points change than are told");
}

void check(const State& before, const State& after, const Claim& claim)
{
    checkAttributes(before, after, claim);
    checkColumns(before, after, claim);
    PointSet flipped = before.deleted, back = after.deleted;
    flipped.remove(after.deleted);
    back.remove(before.deleted);
    flipped.insert(back);
    promise(claim.deletes || flipped.count() == 0, "only what says so deletes or restores");
    promise(flipped.count() <= claim.most, "no more points are deleted or restored than are told");
    flipped.remove(claim.points);
    promise(flipped.count() == 0, "only points that are named are deleted or restored");
}

// -- the text

/// The lines, with their sums, after the two that a journal of this cloud begins with.
std::string withSums(std::string_view lines, const CloudKey& key)
{
    std::uint32_t sum = 0;
    std::string text = summed(std::string(kJournalFirstLine), sum);
    text += summed(journalCloudLine(key, "made"), sum);
    while (!lines.empty()) {
        const std::size_t end = std::min(lines.find('\n'), lines.size());
        text += summed(std::string(lines.substr(0, end)), sum);
        lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    return text;
}

/// What was read is written as a line that reads the same.
void checkLine(const JournalEntry& entry, const CloudKey& key)
{
    if (entry.kind != JournalEntry::Kind::Do) return;
    JournalEntry noted = entry;
    if (entry.within) noted.recipe.within = std::make_shared<PointSet>(entry.within->unpacked());
    const std::string line = journalLine(noted);
    const SoundJournal again = soundPart("again", withSums(line, key));
    promise(again.contents.damage.empty() && again.contents.entries.size() == 1, "an entry can be noted");
    const JournalEntry& read = again.contents.entries[0];
    promise(read.changed == entry.changed && read.name == entry.name && read.recipe.step == entry.recipe.step &&
                read.recipe.values == entry.recipe.values && read.within.has_value() == entry.within.has_value() &&
                (!read.within || read.within->unpacked() == entry.within->unpacked()),
            "an entry reads as it was noted");
}

/// A folder for what a history moves out of memory.
const std::filesystem::path& spillFolder()
{
    static const std::filesystem::path folder =
        std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
    return folder;
}

void followAll(const JournalContents& journal, const fuzz::Fixed& fixed, HistoryRoom room)
{
    const auto cloud = fuzz::copyOf(*fixed.cloud);
    History history(cloud, std::move(room));
    Progress progress;
    std::vector<State> states{stateOf(*cloud)};  // after each command of the history
    std::size_t position = 0;
    promise(equal(states[0], stateOf(*fixed.cloud)), "a copy is the same");
    for (const JournalEntry& entry : journal.entries) {
        if (states.size() > kMostEntries) break;
        checkLine(entry, fixed.key);
        try {
            follow(entry, *cloud, history, progress);
        } catch (const Error& e) {
            fuzz::checkSentence(e);
            promise(equal(stateOf(*cloud), states[position]), "what cannot be followed changes nothing");
            break;
        }
        const State after = stateOf(*cloud);
        if (entry.kind == JournalEntry::Kind::Undo) {
            promise(position > 0 && equal(after, states[--position]), "undo leads to the state before");
        } else if (entry.kind == JournalEntry::Kind::Redo) {
            promise(position + 1 < states.size() && equal(after, states[++position]), "redo leads to it again");
        } else {
            check(states[position], after, claimOf(entry, states[position]));
            states.resize(++position);
            states.push_back(after);
        }
        promise(history.position() == position, "an entry is one step of the history");
    }
    while (history.canUndo()) {
        history.undo();
        promise(equal(stateOf(*cloud), states[--position]), "undo leads to each state before");
    }
    promise(position == 0, "undo of all leads to the first state");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    fuzz::Input input(data, size);
    const auto flags = input.take<std::uint8_t>();
    const std::string rest(reinterpret_cast<const char*>(input.rest().data()), input.rest().size());
    const fuzz::Fixed& fixed = fuzz::fixedCloud((flags & 2) != 0);
    SoundJournal sound;
    try {
        sound = soundPart("fuzzed", (flags & 1) != 0 ? rest : withSums(rest, fixed.key));
    } catch (const Error& e) {
        fuzz::checkSentence(e);
        return 0;
    }
    if (!sound.contents.damage.empty()) fuzz::checkSentences({sound.contents.damage});
    promise(sound.contents.inForce().size() == sound.position, "what is in force is told");
    HistoryRoom room;
    if ((flags & 4) != 0) room.loose = 0;
    if ((flags & 8) != 0) {
        room.memory = 0;
        room.folder = spillFolder();
    }
    if (!(sound.contents.key == fixed.key)) return 0;
    followAll(sound.contents, fixed, std::move(room));
    return 0;
}
