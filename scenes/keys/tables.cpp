// The catalog of keys as tables of Markdown and as lines for a terminal.
#include <map>

#include "scenes/keys/catalog.h"

namespace isochor::keys {

namespace {

std::string in_code(const std::string& text) {
  return "`" + text + "`";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

std::string unit_text(const std::string& unit) {
  return unit.empty() ? "–" : replaced(replaced(unit, "^3", "³"), "^2", "²");
}

std::string bounds_text(const Bounds& b) {
  const auto shown = [](double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", v);
    return std::string(text);
  };
  std::string text;
  if (b.least) text = "≥ " + shown(*b.least);
  if (b.above) text = "> " + shown(*b.above);
  if (b.most) text += (text.empty() ? "≤ " : ", ≤ ") + shown(*b.most);
  return text;
}

std::string default_text(const CatalogKey& key) {
  if (!key.without.empty()) return key.without;
  if (key.standard.empty()) return {};
  if (key.standard.front() == '"') return in_code(key.standard.substr(1, key.standard.size() - 2));
  return key.standard;
}

std::string row(const Catalog& catalog, const CatalogKey& key) {
  std::string meaning = key.meaning;
  if (meaning.empty() && !key.type.empty()) meaning = catalog.of(key.type).what;
  const auto add = [&](const std::string& divider, const std::string& text) {
    if (!text.empty()) meaning += (meaning.empty() ? "" : divider) + text;
  };
  std::string words;
  for (const std::string& word : key.words) words += (words.empty() ? "" : ", ") + in_code(word);
  add(": ", words);
  add("; ", bounds_text(key.bounds));
  const std::string standard = default_text(key);
  if (!standard.empty()) add(" ", "(" + standard + ")");
  const std::string name = in_code(key.name);
  return "| " + (key.needed ? "**" + name + "**" : name) + " | " + key.kind + " | " + unit_text(key.unit) +
         " | " + meaning + " |\n";
}

std::string heading(const std::vector<std::string>& places) {
  std::string text;
  for (const std::string& place : places)
    text += (text.empty() ? "" : ", ") + (place.empty() ? "scene" : in_code(place));
  return text;
}

}  // namespace

std::string plain_text(const std::string& markdown) {
  std::string text;
  for (std::size_t i = 0; i < markdown.size(); ++i) {
    const char c = markdown[i];
    // [words](address), but not [[lower, upper], ...].
    const auto middle = c == '[' ? markdown.find("](", i) : std::string::npos;
    const auto end = middle == std::string::npos ? middle : markdown.find(')', middle);
    if (end != std::string::npos && markdown.find('[', i + 1) > middle) {
      text += markdown.substr(i + 1, middle - i - 1);
      i = end;
    } else if (c != '`') {
      text += c;
    }
  }
  return text;
}

std::string key_tables(const Catalog& catalog) {
  std::map<std::string, std::vector<std::string>> places;
  walk(catalog, catalog.objects.front(), "",
       [&](const std::string& place, const CatalogObject& object) { places[object.type].push_back(place); });
  std::string text;
  for (const CatalogObject& object : catalog.objects) {
    text += "### " + heading(places[object.type]) + "\n\n" + object.what + "\n\n";
    text += "| key | kind | unit | meaning (default) |\n|---|---|---|---|\n";
    for (const CatalogKey& key : object.keys) text += row(catalog, key);
    text += "\n";
  }
  return text;
}

std::string key_lines(const Catalog& catalog) {
  std::string text;
  walk(catalog, catalog.objects.front(), "", [&](const std::string& place, const CatalogObject& object) {
    for (const CatalogKey& key : object.keys) {
      text += (place.empty() ? "" : place + ".") + key.name + ": ";
      std::string words;
      for (const std::string& word : key.words) words += (words.empty() ? "" : "|") + word;
      text += words.empty() ? key.kind : words;
      if (!key.unit.empty()) text += " [" + key.unit + "]";
      if (key.needed) text += ", required";
      if (const std::string standard = plain_text(default_text(key)); !standard.empty())
        text += ", default " + standard;
      if (!key.meaning.empty()) text += ". " + plain_text(key.meaning);
      text += "\n";
    }
  });
  return text;
}

}  // namespace isochor::keys
