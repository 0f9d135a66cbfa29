#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "silpose/base/text_file.h"
#include "silpose/experiment/grid.h"
#include "silpose/experiment/toml_entry.h"

namespace silpose {
namespace {

using Texts = std::vector<std::string>;
using Entry = TomlEntry;

// One point of an axis: its label, and what it sets.
struct AxisValue {
  std::string label;
  toml::table settings;
};
struct Axis {
  std::string name;
  std::vector<AxisValue> values;
};

// values: tables with a label, or, with `key`, plain values of that setting, which label themselves.
Result<Axis> read_axis(const toml::table& table, const std::string& file) {
  Axis axis;
  const std::string where = file + ": axis";
  std::string key;
  for (const auto& [word, node] : table) {
    const Entry entry{node, fmt::format("{}.{}", where, word.str())};
    if (word == "name" || word == "key") {
      const Result<void> taken = take(text_of(entry), word == "name" ? axis.name : key);
      if (!taken) return taken.failure();
    } else if (word != "values") {
      return error("{}: no such key (name, key, values)", entry.where);
    }
  }
  if (axis.name.empty()) return error("{}.name: is missing", where);
  const std::string values = fmt::format("{} '{}'.values", where, axis.name);
  const toml::array* const array = table["values"].as_array();
  if (array == nullptr || array->empty()) return error("{}: a list is wanted", values);
  std::set<std::string> labels;
  for (const toml::node& node : *array) {
    AxisValue value;
    if (const toml::table* const settings = node.as_table(); settings != nullptr && key.empty()) {
      const auto label = (*settings)["label"].value_exact<std::string>();
      if (!label) return error("{}: each needs a label, a text", values);
      value = {*label, *settings};
      value.settings.erase("label");
    } else if (settings == nullptr && !key.empty()) {
      value.label = node.is_string() ? *node.value<std::string>() : fmt::format("{:g}", node.value_or(0.0));
      value.settings.insert(key, node);
    } else {
      return error("{}: tables with a label are wanted, or with `key` plain values", values);
    }
    if (value.label.empty() || value.label.find_first_of(",\"\n\r/") != std::string::npos) {
      return error("{}: '{}' is no label: empty, or with a comma, quote, slash or line break", values, value.label);
    }
    if (!labels.insert(value.label).second) return error("{}: '{}' is there twice", values, value.label);
    axis.values.push_back(std::move(value));
  }
  return axis;
}

// [quick.axes] NAME = [labels]: only those stay.
Result<void> keep_only(const toml::table& chosen, const std::string& file, std::vector<Axis>& axes) {
  for (const auto& [key, node] : chosen) {
    const std::string name(key.str());
    const Entry entry{node, fmt::format("{}: quick.axes.{}", file, name)};
    const auto axis = std::find_if(axes.begin(), axes.end(), [&](const Axis& a) { return a.name == name; });
    if (axis == axes.end()) return error("{}: no such axis", entry.where);
    const Result<Texts> labels = texts_of(entry);
    if (!labels) return labels.failure();
    std::vector<AxisValue> kept;
    for (const std::string& label : *labels) {
      const auto value =
          std::find_if(axis->values.begin(), axis->values.end(), [&](const AxisValue& v) { return v.label == label; });
      if (value == axis->values.end()) return error("{}: the axis has no '{}'", entry.where, label);
      kept.push_back(*value);
    }
    if (kept.empty()) return error("{}: names none", entry.where);
    axis->values = std::move(kept);
  }
  return {};
}

// A cell that is being put together.
struct Growing {
  GridCell cell;
  GivenSettings given;
};

// [[without]] AXIS = [labels]: cells that have one of these labels on each of the axes named are left out.
using Without = std::map<std::string, Texts>;

Result<Without> read_without(const toml::table& table, const std::vector<Axis>& axes, const std::string& file) {
  Without without;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const Entry entry{node, fmt::format("{}: without.{}", file, name)};
    const auto axis = std::ranges::find(axes, name, &Axis::name);
    if (axis == axes.end()) return error("{}: no such axis", entry.where);
    const Result<Texts> labels = texts_of(entry);
    if (!labels) return labels.failure();
    for (const std::string& label : *labels) {
      if (std::ranges::find(axis->values, label, &AxisValue::label) == axis->values.end()) {
        return error("{}: the axis has no '{}'", entry.where, label);
      }
    }
    without.emplace(name, *labels);
  }
  if (without.empty()) return error("{}: without: names no axis", file);
  return without;
}

bool is_left_out(const GridCell& cell, const std::vector<GridAxis>& axes, const std::vector<Without>& all) {
  return std::ranges::any_of(all, [&](const Without& without) {
    return std::ranges::all_of(without, [&](const auto& entry) {
      const auto axis = std::ranges::find(axes, entry.first, &GridAxis::name) - axes.begin();
      return std::ranges::count(entry.second, cell.labels[static_cast<size_t>(axis)]) > 0;
    });
  });
}

// Every combination of the axes' values but those left out, the last axis fastest; `last` wins over everything.
Result<void> make_cells(const std::vector<Axis>& axes, const std::vector<Without>& left_out, const toml::table* last,
                        const Growing& base, const std::string& file, Grid& grid) {
  for (const Axis& axis : axes) {
    grid.axes.push_back({axis.name, {}});
    for (const AxisValue& value : axis.values) grid.axes.back().labels.push_back(value.label);
  }
  std::vector<Growing> cells = {base};
  for (const Axis& axis : axes) {
    std::vector<Growing> longer;
    for (const Growing& shorter : cells) {
      for (const AxisValue& value : axis.values) {
        Growing next = shorter;
        next.cell.labels.push_back(value.label);
        const std::string where = fmt::format("{}: axis '{}', '{}'", file, axis.name, value.label);
        const Result<void> applied = apply_settings(value.settings, where, next.cell.settings, &next.given);
        if (!applied) return applied.failure();
        longer.push_back(std::move(next));
      }
    }
    cells = std::move(longer);
  }
  for (auto& [cell, given] : cells) {
    if (is_left_out(cell, grid.axes, left_out)) continue;
    if (last != nullptr) {
      const Result<void> applied = apply_settings(*last, file + ": quick.run", cell.settings, &given);
      if (!applied) return applied.failure();
    }
    const Result<void> checked = check_settings(given, cell.settings);
    if (!checked) return checked.failure();
    grid.cells.push_back(std::move(cell));
  }
  if (grid.cells.empty()) return error("{}: without: leaves no cell", file);
  return {};
}

Result<void> check_axes_named(const Texts& names, const Grid& grid, const std::string& where) {
  for (const std::string& name : names) {
    const bool known =
        std::any_of(grid.axes.begin(), grid.axes.end(), [&](const GridAxis& axis) { return axis.name == name; });
    if (!known) return error("{}: no axis '{}'", where, name);
  }
  return {};
}

Result<TableDescription> read_table(const toml::table& table, const Grid& grid, const std::string& file) {
  TableDescription description;
  for (const auto& [key, node] : table) {
    const Entry entry{node, fmt::format("{}: table.{}", file, key.str())};
    Result<void> taken;
    if (key == "name")
      taken = take(text_of(entry), description.name);
    else if (key == "title")
      taken = take(text_of(entry), description.title);
    else if (key == "family")
      taken = take(text_of(entry), description.family);
    else if (key == "beside")
      taken = take(text_of(entry), description.beside);
    else if (key == "mean_row")
      taken = take(flag_of(entry), description.mean_row);
    else if (key == "figures")
      taken = take(texts_of(entry), description.figures);
    else if (key == "rows" || key == "columns") {
      Texts& axes = key == "rows" ? description.rows : description.columns;
      taken = take(texts_of(entry), axes);
      if (taken) taken = check_axes_named(axes, grid, entry.where);
    } else {
      taken = error("{}: no such key", entry.where);
    }
    if (!taken) return taken.failure();
  }
  if (description.name.empty()) return error("{}: table.name: is missing", file);
  if (description.name == "runs" || description.name == "frames") {
    return error("{}: table.name: '{}' is the name of another file", file, description.name);
  }
  if (description.figures.empty() == description.family.empty()) {
    return error("{}: table '{}': either figures or family is wanted", file, description.name);
  }
  return description;
}

Result<PlotDescription> read_plot(const toml::table& table, const Grid& grid, const std::string& file) {
  PlotDescription plot;
  for (const auto& [key, node] : table) {
    const Entry entry{node, fmt::format("{}: plot.{}", file, key.str())};
    Result<void> taken;
    if (key == "name")
      taken = take(text_of(entry), plot.name);
    else if (key == "title")
      taken = take(text_of(entry), plot.title);
    else if (key == "x")
      taken = take(text_of(entry), plot.x);
    else if (key == "series")
      taken = take(text_of(entry), plot.series);
    else if (key == "figure")
      taken = take(text_of(entry), plot.figure);
    else if (key == "label")
      taken = take(text_of(entry), plot.label);
    else if (key == "beside")
      taken = take(texts_of(entry), plot.beside);
    else
      taken = error("{}: no such key", entry.where);
    if (!taken) return taken.failure();
  }
  for (const auto& [word, text] :
       {std::pair<const char*, std::string>{"name", plot.name}, {"x", plot.x}, {"figure", plot.figure}}) {
    if (text.empty()) return error("{}: plot.{}: is missing", file, word);
  }
  const std::string where = fmt::format("{}: plot '{}'", file, plot.name);
  Texts axes;
  if (plot.x != "frame") axes.push_back(plot.x);
  if (!plot.series.empty()) axes.push_back(plot.series);
  const Result<void> known = check_axes_named(axes, grid, where);
  if (!known) return known.failure();
  return plot;
}

// The tables of an array of tables. Errors: it is something else.
Result<std::vector<const toml::table*>> tables_of(const toml::table& root, const std::string& key,
                                                  const std::string& file) {
  std::vector<const toml::table*> tables;
  const toml::node* const node = root.get(key);
  if (node == nullptr) return tables;
  const toml::array* const array = node->as_array();
  if (array == nullptr) return error("{}: {}: [[{}]] is wanted", file, key, key);
  for (const toml::node& element : *array) {
    if (element.as_table() == nullptr) return error("{}: {}: [[{}]] is wanted", file, key, key);
    tables.push_back(element.as_table());
  }
  return tables;
}

// [quick]: how the same grid is made small.
struct Quick {
  std::optional<int> seeds;
  const toml::table* run = nullptr;
  const toml::table* axes = nullptr;
};

Result<Quick> read_quick(const toml::table& root, const std::string& file) {
  Quick quick;
  const toml::node* const node = root.get("quick");
  if (node == nullptr) return quick;
  const toml::table* const table = node->as_table();
  if (table == nullptr) return error("{}: quick: a table is wanted", file);
  for (const auto& [key, value] : *table) {
    const Entry entry{value, fmt::format("{}: quick.{}", file, key.str())};
    if (key == "seeds") {
      const Result<void> taken = take(integer_of(entry, 1, 10000), quick.seeds);
      if (!taken) return taken.failure();
    } else if (key == "run" || key == "axes") {
      if (value.as_table() == nullptr) return error("{}: a table is wanted", entry.where);
      (key == "run" ? quick.run : quick.axes) = value.as_table();
    } else {
      return error("{}: no such key (seeds, run, axes)", entry.where);
    }
  }
  return quick;
}

Result<toml::table> parse_file(const std::filesystem::path& path) {
  const Result<std::string> text = read_text_file(path);
  if (!text) return text.failure();
  try {
    return toml::parse(std::string_view(*text));
  } catch (const toml::parse_error& broken) {
    return error("{}: line {}: {}", path.string(), broken.source().begin.line, broken.description());
  }
}

// What is made of the results: tables and plots.
Result<void> read_outputs(const toml::table& root, const std::string& file, Grid& grid) {
  const auto tables = tables_of(root, "table", file), plots = tables_of(root, "plot", file);
  if (!tables) return tables.failure();
  if (!plots) return plots.failure();
  if (tables->empty()) return error("{}: table: at least one [[table]] is wanted", file);
  for (const toml::table* const table : *tables) {
    Result<TableDescription> description = read_table(*table, grid, file);
    if (!description) return description.failure();
    grid.tables.push_back(std::move(*description));
  }
  for (const toml::table* const table : *plots) {
    Result<PlotDescription> plot = read_plot(*table, grid, file);
    if (!plot) return plot.failure();
    grid.plots.push_back(std::move(*plot));
  }
  return {};
}

}  // namespace

Result<Grid> read_grid(const std::filesystem::path& path, bool quick_wanted) {
  const std::string file = path.string();
  const Result<toml::table> parsed = parse_file(path);
  if (!parsed) return parsed.failure();
  const toml::table& root = *parsed;
  Grid grid;
  grid.name = path.stem().string();
  grid.folder = path.parent_path();
  Growing base;
  for (const auto& [key, node] : root) {
    const Entry entry{node, fmt::format("{}: {}", file, key.str())};
    Result<void> taken;
    if (key == "title") {
      taken = take(text_of(entry), grid.title);
    } else if (key == "seeds") {
      taken = take(integer_of(entry, 1, 10000), grid.seeds);
    } else if (key == "run") {
      const toml::table* const run = node.as_table();
      taken = run == nullptr ? Result<void>(error("{}: a table is wanted", entry.where))
                             : apply_settings(*run, entry.where, base.cell.settings, &base.given);
    } else if (key != "axis" && key != "table" && key != "plot" && key != "quick" && key != "without") {
      taken = error("{}: no such key", entry.where);
    }
    if (!taken) return taken.failure();
  }
  const Result<Quick> quick = read_quick(root, file);
  if (!quick) return quick.failure();
  if (quick_wanted) grid.seeds = quick->seeds.value_or(1);

  std::vector<Axis> axes;
  const auto axis_tables = tables_of(root, "axis", file);
  if (!axis_tables) return axis_tables.failure();
  for (const toml::table* const table : *axis_tables) {
    Result<Axis> axis = read_axis(*table, file);
    if (!axis) return axis.failure();
    axes.push_back(std::move(*axis));
  }
  std::vector<Without> left_out;
  const auto without_tables = tables_of(root, "without", file);
  if (!without_tables) return without_tables.failure();
  for (const toml::table* const table : *without_tables) {
    Result<Without> without = read_without(*table, axes, file);
    if (!without) return without.failure();
    left_out.push_back(std::move(*without));
  }
  if (quick_wanted && quick->axes != nullptr) {
    const Result<void> kept = keep_only(*quick->axes, file, axes);
    if (!kept) return kept.failure();
  }
  const Result<void> made = make_cells(axes, left_out, quick_wanted ? quick->run : nullptr, base, file, grid);
  if (!made) return made.failure();

  if (const Result<void> read = read_outputs(root, file, grid); !read) return read.failure();
  return grid;
}

}  // namespace silpose
