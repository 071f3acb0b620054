/// Statements of scripts, one after the other.
#include "app/imports/script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "app/imports/expression.hpp"
#include "core/error.hpp"

namespace rosin::app::imports {

Dialect dialect_of(std::string_view text) {
  for (const std::string_view sure : {"import ", "set_dict"})
    if (text.find(sure) != std::string_view::npos) return Dialect::python;
  long matlab = text.find("qdyn('") != std::string_view::npos ? 1 : 0;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    auto line = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), end + 1));
    line.remove_prefix(std::min(line.size(), line.find_first_not_of(" \t")));
    line = line.substr(0, line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    matlab += line.front() == '%' || line.back() == ';' || line.find("; ") != std::string_view::npos ? 1 : 0;
    matlab -= line.front() == '#' || line.find(" # ") != std::string_view::npos ? 1 : 0;
  }
  return matlab > 0 ? Dialect::matlab : Dialect::python;
}

std::shared_ptr<Record> record_of(const Value& value) {
  const auto* pointer = value.as<std::shared_ptr<Record>>();
  return pointer ? *pointer : nullptr;
}

namespace {

/// All objects in a value may have been changed at a line.
void hand_over(const Value& value, int line) {
  if (const auto record = record_of(value)) record->handed_over = line;
  if (const auto* list = value.as<std::shared_ptr<List>>())
    for (const auto& element : **list) hand_over(element, line);
}

bool one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

std::string_view first_word(std::string_view text) {
  std::size_t length = 0;
  while (length < text.size() && (std::isalnum(static_cast<unsigned char>(text[length])) || text[length] == '_'))
    ++length;
  return text.substr(0, length);
}

/// "if __name__ == '__main__':" holds whenever a script is run.
bool always_runs(std::string_view text) {
  return text.starts_with("if __name__") && text.find("__main__") != std::string_view::npos;
}

}  // namespace

/// What each statement does to the variables.
class Statements {
 public:
  Statements(Script& script, Dialect dialect, const Call& call) : script_(script), dialect_(dialect), call_(call) {}

  void all(const std::vector<Statement>& statements) {
    if (dialect_ == Dialect::python)
      python(statements);
    else
      matlab(statements);
  }

 private:
  void python(const std::vector<Statement>& statements) {
    for (const auto& statement : statements)
      if (one_of(first_word(statement.text), {"def", "class"}))
        own_functions_.emplace(
            first_word(std::string_view(statement.text)
                           .substr(std::min(statement.text.size(), statement.text.find_first_of(" \t") + 1))));
    std::vector<std::pair<int, bool>> blocks;  // indent of the head, and whether it is a function's
    for (const auto& statement : statements) {
      while (!blocks.empty() && statement.indent <= blocks.back().first) blocks.pop_back();
      const auto word = first_word(statement.text);
      const bool function = one_of(word, {"def", "class"});
      const bool head =
          function || one_of(word, {"if", "elif", "else", "for", "while", "try", "except", "finally", "with", "async"});
      if (always_runs(statement.text)) continue;
      in_block_ = !blocks.empty();
      in_function_ = std::ranges::any_of(blocks, [](const auto& block) { return block.second; });
      if (!head) {
        perform(statement);
        continue;
      }
      if (statement.text.back() == ':') {
        blocks.push_back({statement.indent, function});
        continue;
      }
      in_block_ = true;
      in_function_ = in_function_ || function;
      auto rest = statement;
      rest.text = rest.text.substr(std::min(rest.text.size(), rest.text.rfind(':') + 1));
      perform(rest);
    }
  }

  void matlab(const std::vector<Statement>& statements) {
    int open = 0;
    bool any = false;
    for (const auto& statement : statements) {
      const auto word = first_word(statement.text);
      if (word == "function") {
        if (any) return;  // functions of its own stand at the end
        any = true;
        continue;
      }
      any = true;
      if (one_of(word, {"if", "for", "while", "switch", "try", "parfor"})) {
        const auto end = statement.text.rfind("end");
        const bool closed = end != std::string::npos && end > 0 && statement.text.size() == end + 3;
        in_block_ = true;
        for (auto rest = statement; !rest.text.empty();) {  // what stands on the same line
          const auto comma = std::min(rest.text.find(','), rest.text.size());
          auto part = rest;
          part.text = rest.text.substr(0, comma);
          if (part.text.find('=') != std::string::npos && !one_of(first_word(part.text), {"if", "while", "switch"}))
            perform(part);
          rest.text = rest.text.substr(std::min(rest.text.size(), comma + 1));
        }
        open += closed ? 0 : 1;
        continue;
      }
      if (word == "end") {
        open = std::max(0, open - 1);
        continue;
      }
      in_block_ = open > 0;
      perform(statement);
    }
  }

  Surroundings surroundings(int line) {
    return {script_.variables_, dialect_, call_, own_functions_, line, numbers_made_};
  }

  void perform(const Statement& statement) {
    std::vector<Token> tokens;
    if (!tokens_of(statement.text, dialect_, tokens)) {
      unreadable(statement);
      return;
    }
    if (tokens.size() < 2) return;
    if (one_of(tokens.front().word, {"import", "from", "return", "global", "assert", "print"}) &&
        tokens.front().kind == Token::name)
      return;
    // every = on the first level divides
    std::vector<std::size_t> signs;
    int depth = 0;
    for (std::size_t i = 0; i < tokens.size(); ++i) {
      if (tokens[i].kind != Token::symbol) continue;
      if (one_of(tokens[i].word, {"(", "[", "{"})) ++depth;
      if (one_of(tokens[i].word, {")", "]", "}"})) --depth;
      if (depth == 0 && one_of(tokens[i].word, {"=", "+=", "-=", "*=", "/=", "**=", "//="})) signs.push_back(i);
    }
    auto around = surroundings(statement.line);
    if (tokens.front().kind == Token::name && one_of(tokens.front().word, {"exec", "eval", "evalin", "assignin"}))
      for (const auto& token : tokens)
        if (std::vector<Token> run; token.kind == Token::text && tokens_of(token.word, dialect_, run))
          changed_unseen(run, statement.line);
    if (signs.empty()) {
      if (!in_block_) Expression(tokens, around).value();  // a call, which may hand something over
      return;
    }
    Value value = Expression(std::span(tokens).subspan(signs.back() + 1), around).value();
    const std::string sign = tokens[signs.back()].word;
    std::size_t begin = 0;
    for (const auto at : signs) {
      std::vector<Token> left(tokens.begin() + static_cast<long>(begin), tokens.begin() + static_cast<long>(at));
      left.push_back({});
      begin = at + 1;
      assign(left, sign, value, statement.line);
    }
  }

  /// A line that is none of the language, as far as it is read: a name that it gives a value to is not known.
  void unreadable(const Statement& statement) {
    const auto sign = statement.text.find('=');
    if (sign == std::string::npos) return;
    std::vector<Token> left;
    if (tokens_of(std::string_view(statement.text).substr(0, sign), dialect_, left))
      assign(left, "=", {Unknown{}}, statement.line);
  }

  void assign(const std::vector<Token>& left, const std::string& sign, Value value, int line) {
    auto around = surroundings(line);
    if (in_block_) value = {Unknown{"stands in a loop, a condition or a function, which is not run"}};
    Target target;
    if (!Expression(without_annotation(left), around).target(target)) {
      several(left, value, line);
      return;
    }
    if (in_function_ && target.steps.size() == 1) return;  // a name of the function's own
    if (sign != "=" && !in_block_) {
      const auto before = Expression(left, around).value();
      value = combined(before, sign.substr(0, sign.size() - 1), value, around);
      const auto *changed = before.as<std::shared_ptr<Vector>>(), *made = value.as<std::shared_ptr<Vector>>();
      if (changed && made && (*changed)->numbers.size() == (*made)->numbers.size()) {
        (*changed)->numbers = (*made)->numbers;  // under all names of the vector
        value = before;
      }
    }
    put(target, value, line);
  }

  /// "a" of "a: float = 1".
  std::vector<Token> without_annotation(const std::vector<Token>& left) const {
    int depth = 0;
    for (std::size_t i = 0; dialect_ == Dialect::python && i < left.size(); ++i) {
      if (left[i].kind != Token::symbol) continue;
      if (one_of(left[i].word, {"(", "[", "{"})) ++depth;
      if (one_of(left[i].word, {")", "]", "}"})) --depth;
      if (depth != 0 || left[i].word != ":") continue;
      std::vector<Token> plain(left.begin(), left.begin() + static_cast<long>(i));
      plain.push_back({});
      return plain;
    }
    return left;
  }

  /// A statement that is not understood may change all that it names.
  void changed_unseen(const std::vector<Token>& tokens, int line) {
    for (const auto& token : tokens) {
      if (token.kind != Token::name && token.kind != Token::text) continue;
      const auto slot = script_.variables_.slots.find(token.word);
      if (slot != script_.variables_.slots.end()) changed_unseen(slot->second, line);
    }
  }
  void changed_unseen(Slot& slot, int line) {
    hand_over(slot.value, line);
    if (!record_of(slot.value)) slot = {{Unknown{"is changed in a way that is not understood"}}, line};
  }

  /// "[p, ot, ox] = qdyn(…)" of MATLAB gives the first its value; of other lists each name is not known.
  void several(const std::vector<Token>& left, const Value& value, int line) {
    bool first = dialect_ == Dialect::matlab;
    auto around = surroundings(line);
    std::vector<Token> part;
    int depth = 0;
    for (const auto& token : left) {
      const bool symbol = token.kind == Token::symbol;
      const bool outer = symbol && depth == 0 && one_of(token.word, {"[", "(", "]", ")"}) && part.empty();
      if (symbol && one_of(token.word, {"[", "("})) ++depth;
      if (symbol && one_of(token.word, {"]", ")"})) --depth;
      const bool closes =
          symbol && depth == 0 && one_of(token.word, {"]", ")"}) && !part.empty() && dialect_ == Dialect::matlab;
      if (outer) continue;
      if (closes || token.kind == Token::end || (symbol && token.word == "," && depth <= 1)) {
        part.push_back({});
        Target target;
        if (part.size() > 1 && Expression(part, around).target(target)) {
          put(target, first ? value : Value{Unknown{"is one of several values that are given together"}}, line);
          first = false;
        } else {
          changed_unseen(part, line);
        }
        part.clear();
        continue;
      }
      part.push_back(token);
    }
  }

  void put(const Target& target, const Value& value, int line) {
    Record* record = &script_.variables_;
    std::shared_ptr<Record> hold;
    for (std::size_t i = 0; i < target.steps.size(); ++i) {
      const auto& step = target.steps[i];
      const bool last = i + 1 == target.steps.size();
      if (!step.subscripts.empty()) return;  // handled with the name before it
      if (!last && !target.steps[i + 1].subscripts.empty()) {
        auto& slot = record->slots[step.name];
        const bool ends = i + 2 == target.steps.size();
        if (!ends || !put_elements(slot.value, target.steps[i + 1].subscripts, value)) {
          hand_over(slot.value, line);
          slot.value = {Unknown{"is changed in a part that is not understood"}};
        }
        slot.line = line;
        return;
      }
      if (last) {
        record->slots[step.name] = {value, line};
        return;
      }
      auto& slot = record->slots[step.name];
      hold = record_of(slot.value);
      if (!hold) {
        hold = std::make_shared<Record>();
        slot = {{hold}, line};
      }
      record = hold.get();
    }
  }

  bool put_elements(Value& of, const std::vector<Subscript>& subscripts, const Value& value) {
    if (subscripts.size() != 1) return false;
    std::vector<std::size_t> elements;
    if (of.as<double>()) {  // of one number its only element
      if (!chosen(subscripts.front(), 1, dialect_, elements) || elements.size() != 1 || !value.as<double>())
        return false;
      of = value;
      return true;
    }
    const auto* pointer = of.as<std::shared_ptr<Vector>>();
    if (!pointer || !chosen(subscripts.front(), (*pointer)->numbers.size(), dialect_, elements)) return false;
    if (const auto& whole = (*pointer)->part_of) {  // which changes too, in a part that is not kept
      whole->numbers.clear();
      return false;
    }
    const auto* one = value.as<double>();
    const auto* many = value.as<std::shared_ptr<Vector>>();
    if (!one && (!many || (*many)->numbers.size() != elements.size())) return false;
    for (std::size_t i = 0; i < elements.size(); ++i)
      (*pointer)->numbers[elements[i]] = one ? *one : (*many)->numbers[i];
    return true;
  }

  Script& script_;
  Dialect dialect_;
  const Call& call_;
  std::set<std::string, std::less<>> own_functions_;
  std::size_t numbers_made_ = 0;
  bool in_block_ = false, in_function_ = false;
};

Script::Script(std::string path, std::string_view text, Dialect dialect, Call call, Record known)
    : path_(std::move(path)), variables_(std::move(known)) {
  std::string_view rest = text;
  while (!rest.empty()) {
    const auto end = std::min(rest.find('\n'), rest.size());
    lines_.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(rest.size(), end + 1));
  }
  Statements(*this, dialect, call).all(statements_of(text, dialect, path_));
}

std::string Script::line(int number) const {
  if (number < 1 || static_cast<std::size_t>(number) > lines_.size()) return {};
  auto text = lines_[static_cast<std::size_t>(number) - 1];
  const auto begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  text.erase(0, begin);
  while (!text.empty() && std::string_view(" \t\r").find(text.back()) != std::string_view::npos) text.pop_back();
  constexpr std::size_t most = 120;
  if (text.size() > most) text = text.substr(0, most) + "…";
  return text;
}

void Script::refuse(int line, std::string_view why) const {
  throw InputError(fmt::format("{}:{}: '{}' {}", path_, line, this->line(line), why));
}

}  // namespace rosin::app::imports
