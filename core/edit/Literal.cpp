// SPDX-License-Identifier: MIT
#include "core/edit/Literal.h"

#include "core/Error.h"
#include "core/cloud/KeptPoints.h"
#include "core/edit/ClassCommand.h"
#include "core/edit/CommandGroup.h"
#include "core/edit/DeleteCommand.h"
#include "core/edit/ListCommand.h"
#include "core/edit/PackedValues.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <set>
#include <shared_mutex>
#include <string_view>
#include <utility>

namespace punctum
{

namespace
{

// What the keys of a literal begin with; names of attributes follow, or the place among what is added. They are
// read in this order.
constexpr std::string_view kRemove = "-", kRename = ">", kAdd = "+", kValues = "=";
constexpr std::string_view kName = "name", kDeleted = "deleted";
constexpr char kBetween = '\n';  // of the words of a value
constexpr std::string_view kComposite = "composite", kPlain = "plain", kRuns = "runs";

[[noreturn]] void failReading()
{
    throw Error("It is not understood; a newer Punctum may have noted it.");
}

bool sameField(const Attribute& a, const Attribute& b)
{
    return a.columns[0] == b.columns[0] && a.bitShift == b.bitShift && a.bitWidth == b.bitWidth;
}

const Attribute* find(const std::vector<Attribute>& list, const auto& fits)
{
    const auto found = std::find_if(list.begin(), list.end(), fits);
    return found == list.end() ? nullptr : &*found;
}

std::uint64_t maskOf(const Attribute& a)
{
    return a.bitWidth == 0 ? ~std::uint64_t(0) : a.maxBits();
}

// -- values as text: type, form, base64

std::string textOf(std::span<const std::byte> elements, const Column& column)
{
    const auto packed = packedRuns(elements, column.elementBytes());
    return std::string(nameOf(column.type())) + kBetween + std::string(packed ? kRuns : kPlain) + kBetween +
           toBase64(packed ? std::span<const std::byte>(*packed) : elements);
}

std::vector<std::string_view> split(std::string_view text)
{
    std::vector<std::string_view> words;
    for (;;) {
        const std::size_t end = std::min(text.find(kBetween), text.size());
        words.push_back(text.substr(0, end));
        if (end == text.size()) return words;
        text.remove_prefix(end + 1);
    }
}

/// `words`: type, form, base64.
std::vector<std::byte> elementsOf(std::span<const std::string_view> words, std::size_t elementBytes,
                                  PointIndex count)
{
    auto bytes = fromBase64(words[2]);
    if (bytes && words[1] == kRuns) bytes = unpackedRuns(*bytes, elementBytes, count);
    if (!bytes || bytes->size() != count * elementBytes) failReading();
    return std::move(*bytes);
}

template <typename T>
T numberOf(std::string_view text)
{
    T number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) failReading();
    return number;
}

ScalarType typeOf(std::string_view name)
{
    for (int k = 0; k <= int(ScalarType::F64); ++k)
        if (nameOf(ScalarType(k)) == name) return ScalarType(k);
    failReading();
}

std::string doubleText(double v)
{
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), v).ptr};
}

// -- writing

/// Makes the recipe of one move. The cloud's lock is held meanwhile.
class LiteralWriter
{
public:
    LiteralWriter(const Command& command, const PointCloud& cloud, const KeptPoints* kept)
        : m_command(command), m_cloud(cloud), m_points(command.points()), m_kept(cloud.size())
    {
        if (kept == nullptr)
            m_kept.invert();
        else
            for (const PointRange& run : kept->ranges()) m_kept.insert(run);
        m_told = m_kept;
        if (m_points) m_told.intersect(*m_points);
    }

    Recipe write(bool forward)
    {
        m_literal.step = kLiteralStep;
        m_literal.within = m_points;
        m_literal.values[std::string(kName)] = forward ? m_command.name() : "Undo " + m_command.name();
        const Command::Effect effect = m_command.effect();
        lists(forward ? effect.removed : effect.added, forward ? effect.added : effect.removed);
        for (const auto& column : effect.columns) swapped(column, forward ? effect.removed : effect.added);
        if (effect.deletes) {
            const auto& deleted = m_cloud.deleted();
            const bool gone =
                deleted && m_points->extent().size() != 0 && deleted->contains(m_points->extent().first);
            m_literal.values[std::string(kDeleted)] = gone ? "no" : "yes";
        }
        return std::move(m_literal);
    }

private:
    /// Attributes that go, and those that come in the cloud's order.
    void lists(const std::vector<Attribute>& gone, const std::vector<Attribute>& come)
    {
        const auto renamed = [](const Attribute& a, const std::vector<Attribute>& others) {
            return a.components != 1
                       ? nullptr
                       : find(others, [&](const Attribute& b) { return b.components == 1 && sameField(a, b); });
        };
        for (const Attribute& a : gone) {
            if (a.components != 1 || a.standard) continue;  // a composite goes with its parts
            if (const Attribute* const to = renamed(a, come))
                m_literal.values[std::string(kRename) + a.name] = to->name;
            else
                m_literal.values[std::string(kRemove) + a.name] = "";
        }
        for (const Attribute& a : come) {
            if (a.standard && a.components == 1)
                values(a, after(a));  // the file has it, of a type of its own
            else if (renamed(a, gone) == nullptr)
                added(a, come);
        }
    }

    void added(const Attribute& a, const std::vector<Attribute>& come)
    {
        std::string number = std::to_string(m_added++);
        number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
        std::string& text = m_literal.values[std::string(kAdd) + number];
        const auto word = [&](const std::string& w) { (text += w) += kBetween; };
        word(a.name);
        word(std::to_string(int(a.kind)));
        if (a.components != 1) {
            word(std::string(kComposite));
            for (std::uint32_t c = 0; c < a.components; ++c) word(partName(a.columns[c], come));
            text.pop_back();
            return;
        }
        word(std::to_string(a.columns[0]->components()));
        word(a.scaled ? doubleText(a.scale) : "");
        word(a.scaled ? doubleText(a.offset) : "");
        word(a.noData ? std::to_string(a.noData->index()) + toText(*a.noData) : "");
        word(a.unit);
        word(a.description);
        text += textOf(gathered(a, after(a), m_kept), *a.columns[0]);
    }

    std::string partName(const std::shared_ptr<Column>& column, const std::vector<Attribute>& come) const
    {
        const auto shows = [&](const Attribute& a) { return a.components == 1 && a.columns[0] == column; };
        const Attribute* part = find(come, shows);
        if (part == nullptr) part = find(m_cloud.attributes(), shows);
        return part != nullptr ? part->name : column->name();
    }

    /// A column of the cloud: the attributes that it holds, those of bits where they change.
    void swapped(const std::shared_ptr<Column>& column, const std::vector<Attribute>& gone)
    {
        std::vector<std::byte> now;
        for (const Attribute& a : m_cloud.attributes()) {
            const auto sameName = [&](const Attribute& b) { return b.name == a.name; };
            if (a.components != 1 || a.columns[0] != column || find(gone, sameName) != nullptr) continue;
            if (now.empty()) now = after(a);
            const auto* const before = column->data();
            if (a.bitWidth == 0 || gathered(a, now, m_told) != gathered(a, {before, before + now.size()}, m_told))
                values(a, now);
        }
    }

    void values(const Attribute& a, const std::vector<std::byte>& column)
    {
        m_literal.values[std::string(kValues) + a.name] = textOf(gathered(a, column, m_told), *a.columns[0]);
    }

    /// Its column as it is on the other side of the command.
    std::vector<std::byte> after(const Attribute& a) const
    {
        const Column& column = *a.columns[0];
        std::vector<std::byte> bytes(column.data(), column.data() + column.size() * column.elementBytes());
        m_command.cross(column, bytes);
        return bytes;
    }

    /// What the attribute has at these points, an element of the column each.
    static std::vector<std::byte> gathered(const Attribute& a, const std::vector<std::byte>& column,
                                           const PointSet& points)
    {
        const std::size_t bytes = a.columns[0]->elementBytes();
        std::vector<std::byte> elements(points.count() * bytes);
        std::byte* to = elements.data();
        points.forEach([&](PointIndex i) {
            const std::byte* const element = column.data() + i * bytes;
            if (a.bitWidth == 0) {
                std::memcpy(to, element, bytes);
            } else {
                std::uint64_t v = 0;
                std::memcpy(&v, element, bytes);
                v = (v >> a.bitShift) & maskOf(a);
                std::memcpy(to, &v, bytes);
            }
            to += bytes;
        });
        return elements;
    }

    const Command& m_command;
    const PointCloud& m_cloud;
    std::shared_ptr<const PointSet> m_points;  ///< null: all
    PointSet m_kept;                           ///< what the reader will have
    PointSet m_told;                           ///< of m_points
    Recipe m_literal;
    int m_added = 0;
};

// -- reading

/// Makes the command of one literal. The cloud's lock is held meanwhile.
class LiteralReader
{
public:
    LiteralReader(const Recipe& literal, const PointCloud& cloud) : m_literal(literal), m_cloud(cloud)
    {
        m_points = literal.within;
        if (!m_points) {
            auto all = std::make_shared<PointSet>(cloud.size());
            all->invert();
            m_points = std::move(all);
        }
    }

    std::unique_ptr<Command> read()
    {
        for (const auto& [key, text] : m_literal.values)
            if (!isKnown(key)) failReading();
        const std::string name = literalName(m_literal);
        forEach(kRemove, [&](const std::string& attribute, const std::string&) {
            const Attribute& gone = own(attribute);
            if (gone.components != 1) failReading();  // it goes with its parts, which may be others' fields
            m_gone.push_back(gone.columns[0]);
            m_parts.push_back(ListCommand::remove(gone));
        });
        forEach(kRename, [&](const std::string& attribute, const std::string& to) {
            if (m_cloud.findAttribute(to) != nullptr) throw Error("There is an attribute \"" + to + "\" already.");
            const Attribute& renamed = own(attribute);
            if (renamed.components != 1) failReading();
            checkGiven(to, false);
            m_parts.push_back(ListCommand::rename(renamed, to));
        });
        forEach(kAdd, [&](const std::string&, const std::string& text) { add(split(text)); });
        if (!m_added.empty()) m_parts.push_back(std::make_unique<AttributesCommand>(name, m_added));
        forEach(kValues,
                [&](const std::string& attribute, const std::string& text) { set(name, attribute, split(text)); });
        if (const auto deleted = m_literal.values.find(kDeleted); deleted != m_literal.values.end())
            remove(name, yes(deleted->second));
        const bool names = std::all_of(m_literal.values.begin(), m_literal.values.end(), [](const auto& value) {
            return value.first == kName || value.first.starts_with(kRename);
        });
        const PointIndex changed = names ? 0 : m_points->count();
        return std::make_unique<CommandGroup>(name, std::move(m_parts), changed);
    }

private:
    template <typename F>
    void forEach(std::string_view beginning, F f) const
    {
        for (const auto& [key, text] : m_literal.values)
            if (key.starts_with(beginning)) f(key.substr(beginning.size()), text);
    }

    static bool isKnown(std::string_view key)
    {
        return key == kName || key == kDeleted || key.starts_with(kRemove) || key.starts_with(kRename) ||
               key.starts_with(kAdd) || key.starts_with(kValues);
    }

    static bool yes(std::string_view word)
    {
        if (word != "yes" && word != "no") failReading();
        return word == "yes";
    }

    /// Refuses a name that the literal gives twice, or that no attribute of the kind can have: a file's extra bytes
    /// may have any but those of composites.
    void checkGiven(const std::string& name, bool composite)
    {
        const auto control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
        if (name.empty() || std::any_of(name.begin(), name.end(), control)) failReading();
        if (!composite && (name == "RGB" || name == "Normal")) failReading();
        if (!m_given.insert(name).second) failReading();
    }

    const Attribute& own(const std::string& name) const
    {
        const Attribute* const found = m_cloud.findAttribute(name);
        if (found == nullptr) throw Error("This cloud has no attribute \"" + name + "\".");
        checkOwn(*found);
        return *found;
    }

    void add(const std::vector<std::string_view>& words)
    {
        if (words.size() < 4) failReading();
        Attribute a;
        a.name = words[0];
        const int kind = numberOf<int>(words[1]);
        if (kind < 0 || kind > int(AttributeKind::Opaque)) failReading();
        a.kind = AttributeKind(kind);
        // One of the cloud that has the name makes room, which a field of the point format must not.
        if (const Attribute* const there = m_cloud.findAttribute(a.name)) checkOwn(*there);
        const bool composite = words[2] == kComposite;
        checkGiven(a.name, composite);
        if (composite != (a.kind == AttributeKind::Color || a.kind == AttributeKind::Vector)) failReading();
        if (composite) {
            if (words.size() != 6) failReading();
            a.components = 3;
            for (std::size_t c = 0; c < 3; ++c) {
                const auto isPart = [&](const Attribute& other) { return other.name == words[3 + c]; };
                const Attribute* part = find(m_added, isPart);
                if (part == nullptr) part = m_cloud.findAttribute(words[3 + c]);
                if (part == nullptr || part->components != 1) failReading();
                checkOwn(*part);
                a.columns[c] = part->columns[0];
                const Column& column = *a.columns[c];
                const bool goes = std::find(m_gone.begin(), m_gone.end(), a.columns[c]) != m_gone.end();
                if (goes || column.components() != 1 || column.type() != a.type()) failReading();
            }
        } else {
            if (words.size() != 11) failReading();
            const auto components = numberOf<std::uint32_t>(words[2]);
            if (components == 0 || components > 255) failReading();
            if (components != 1 && a.kind != AttributeKind::Opaque) failReading();
            a.scaled = !words[3].empty();
            if (a.scaled) {
                a.scale = numberOf<double>(words[3]);
                a.offset = numberOf<double>(words[4]);
            }
            a.noData = noData(words[5]);
            a.unit = words[6];
            a.description = words[7];
            a.columns[0] = std::make_shared<Column>(a.name, typeOf(words[8]), m_cloud.size(), components);
            const auto elements =
                elementsOf(std::span(words).subspan(8), a.columns[0]->elementBytes(), m_cloud.size());
            std::copy(elements.begin(), elements.end(), a.columns[0]->data());
        }
        m_added.push_back(std::move(a));
    }

    static std::optional<Value> noData(std::string_view word)
    {
        if (word.empty()) return {};
        switch (word[0]) {
            case '0':
                return numberOf<std::int64_t>(word.substr(1));
            case '1':
                return numberOf<std::uint64_t>(word.substr(1));
            default:
                return numberOf<double>(word.substr(1));
        }
    }

    void set(const std::string& name, const std::string& attribute, const std::vector<std::string_view>& words)
    {
        const Attribute* const a = m_cloud.findAttribute(attribute);
        if (a == nullptr || a->components != 1) throw Error("This cloud has no attribute \"" + attribute + "\".");
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (a->columns[0] == m_cloud.columns()[axis]) throw Error("Coordinates stay as they are.");
        if (words.size() != 3) failReading();
        if (typeOf(words[0]) != a->type()) throw Error(attribute + " has another type in this file.");
        const std::size_t bytes = a->columns[0]->elementBytes();
        auto elements = elementsOf(words, bytes, m_points->count());
        if (elements.empty()) return;
        if (a->kind == AttributeKind::Class && a->type() == ScalarType::U8) {  // widens the field where it must
            m_parts.push_back(makeClassCommand(name, *a, m_points, std::move(elements)));
            return;
        }
        if (a->bitWidth != 0)
            for (std::size_t at = 0; at < elements.size(); at += bytes) {
                std::uint64_t v = 0;
                std::memcpy(&v, elements.data() + at, bytes);
                if (v > maskOf(*a)) throw Error(attribute + " is too narrow for its values in this file.");
                v <<= a->bitShift;
                std::memcpy(elements.data() + at, &v, bytes);
            }
        m_parts.push_back(std::make_unique<ValueCommand>(name, *a, m_points, std::move(elements)));
    }

    void remove(const std::string& name, bool gone)
    {
        const auto& deleted = m_cloud.deleted();
        bool fits = true;
        m_points->forEach([&](PointIndex i) { fits = fits && (deleted && deleted->contains(i)) != gone; });
        if (!fits) throw Error("Other points are deleted than were then.");
        m_parts.push_back(std::make_unique<DeleteCommand>(name, m_points));
    }

    const Recipe& m_literal;
    const PointCloud& m_cloud;
    std::shared_ptr<const PointSet> m_points;
    std::vector<Attribute> m_added;
    std::set<std::string> m_given;                ///< names that it gives
    std::vector<std::shared_ptr<Column>> m_gone;  ///< what is removed
    std::vector<std::unique_ptr<Command>> m_parts;
};

}  // namespace

Recipe literalOf(const Command& command, const PointCloud& cloud, bool forward, const KeptPoints* kept)
{
    const std::shared_lock lock(cloud.mutex());
    return LiteralWriter(command, cloud, kept).write(forward);
}

std::string literalName(const Recipe& literal)
{
    const auto name = literal.values.find(kName);
    return name == literal.values.end() ? std::string() : name->second;
}

std::unique_ptr<Command> makeLiteral(const Recipe& literal, const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    return LiteralReader(literal, cloud).read();
}

}  // namespace punctum
