# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Small mistakes that can be made in a line of C++ as clang-format leaves it: which there are, and
which of them a seed draws (docs/mutation.md)."""
import dataclasses
import random
import re


@dataclasses.dataclass(frozen=True)
class Mutation:
    """One line that is broken. What is deleted leaves the line empty, so that no other one moves."""

    file: str  # below the repository
    line: int  # from 1
    kind: str  # "condition negated"
    before: str
    after: str

    def __str__(self):
        changed = f"`{self.before.strip()}` -> `{self.after.strip()}`"
        return f"{self.file}:{self.line} {self.kind}: {changed}"


def sources(folder):
    """The files of a module in which mistakes are made: in its folder and all below it but main/."""
    return [path for path in sorted(folder.rglob("*"))
            if path.suffix in (".cpp", ".h") and path.parent.name != "main"]


def masked(text):
    """The text with blanks for what is in comments and literals; as long, with the same lines."""
    token = re.compile(r'//[^\n]*|/\*.*?\*/|R"([^ ()\\\n]*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"'
                       r"|(?<![0-9A-Fa-f])'(?:\\.|[^'\\\n])*'", re.DOTALL)
    return token.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


# Binary operators have blanks around them; < and > of templates, * and & of types have not.
OPERATORS = {
    "<": ("<=", "comparison"), "<=": ("<", "comparison"),
    ">": (">=", "comparison"), ">=": (">", "comparison"),
    "==": ("!=", "comparison"), "!=": ("==", "comparison"),
    "+": ("-", "arithmetic"), "-": ("+", "arithmetic"),
    "*": ("/", "arithmetic"), "/": ("*", "arithmetic"),
    "+=": ("-=", "arithmetic"), "-=": ("+=", "arithmetic"),
    "&&": ("||", "logic"), "||": ("&&", "logic"),
}
OPERATOR = re.compile(r"(?<= )(<=|>=|==|!=|\+=|-=|&&|\|\||[<>+*/-])(?=[ ]|$)")
STEP = re.compile(r"(\+\+|--)(?=\w)|(?<=[\w\])])(\+\+|--)")
TRUTH = re.compile(r"\b(true|false)\b")
NUMBER = re.compile(r"(?<![\w.'])(0x[0-9A-Fa-f']+|[0-9][0-9']*(?:\.[0-9]*)?(?:e[+-]?[0-9]+)?)"
                    r"([uUlLfF]*)(?![\w.'])")
CONDITION = re.compile(r"\b(?:if|while) (?=\()")
# What no function is changed by: declarations, labels, types.
NO_STATEMENT = re.compile(r"(return|using|namespace|template|struct|class|enum|static_assert|case|"
                          r"default|break|continue|public|private|protected|friend|typedef)\b")
TARGET = r"[*(]*(?:\w|::|\.|->|\[[^\]]*\]|\([^()]*\))+"
STATEMENT = re.compile(rf"(?:\((?:void)\))?{TARGET}\(.*\);$"
                       rf"|{TARGET} (?:[-+*/|&^%]|<<|>>)?= .*;$|(?:\+\+|--){TARGET};$")
GUARD = re.compile(r"if \(.*\) [^{]*;$")
FUNCTION = re.compile(r"^ {0,2}(?! ).*\) (?:const |noexcept |override |final )*{$", re.DOTALL)


NO_FUNCTION = ("if", "for", "while", "switch", "else", "return", "namespace", "}")


def closing(text, opening):
    """Index of the bracket that closes the one at `opening`, or -1."""
    depth = 0
    for i in range(opening, len(text)):
        depth += (text[i] == "(") - (text[i] == ")")
        if depth == 0:
            return i
    return -1


def off_by_one(number):
    if number.startswith("0x"):
        digits = number[2:].replace("'", "")
        return f"0x{int(digits, 16) + 1:0{len(digits)}X}"
    if re.fullmatch(r"[0-9']+", number):
        return str(int(number.replace("'", "")) + 1)
    return repr(float(number.replace("'", "")) + 1.0)


def in_line(line, code):
    """(kind, line afterwards) of the mistakes in an expression. @param code the line, masked."""
    def put(match, group, replacement):
        return line[:match.start(group)] + replacement + line[match.end(group):]
    for match in OPERATOR.finditer(code):
        operator = match.group()
        if operator == "+" and '"' in line:
            continue  # joins texts
        replacement, kind = OPERATORS[operator]
        yield kind, put(match, 0, replacement)
    for match in STEP.finditer(code):
        yield "arithmetic", put(match, 0, "--" if match.group() == "++" else "++")
    for match in TRUTH.finditer(code):
        yield "truth", put(match, 0, "false" if match.group() == "true" else "true")
    for match in NUMBER.finditer(code):
        yield "constant off by one", put(match, 1, off_by_one(match.group(1)))
    for match in CONDITION.finditer(code):
        end = closing(code, match.end())
        inside = line[match.end() + 1:end]
        if end > 0 and not re.match(r"(const|auto)\b", inside):
            yield "condition negated", (f"{line[:match.end()]}(!({inside})){line[end + 1:]}")


def returned(signature):
    """What ends a function at once, or None: constructors, and what is no function."""
    words = signature.split("(", 1)[0].split()
    if "=" in words or not words or words[0] in NO_FUNCTION:
        return None
    words = [word for word in words if word not in ("static", "inline", "constexpr", "virtual")]
    if len(words) < 2:
        return None
    return "return;" if words[0] == "void" and len(words) == 2 else "return {};"


def mutations_of(file, text):
    """All mutations of a file, in the order of its lines."""
    lines, codes = text.split("\n"), masked(text).split("\n")
    before = ";"  # how the code before this line ends: whether a statement begins here
    start = 1  # where it began
    for number, (line, code) in enumerate(zip(lines, codes), 1):
        begins, stripped = before in ";{}:", code.strip()
        start = number if begins else start
        before = stripped[-1] if stripped else ";"
        if not stripped or stripped.startswith(("#", "static_assert", "using ", "template")):
            continue
        found = list(in_line(line, code))
        whole = begins and not NO_STATEMENT.match(stripped)
        if whole and STATEMENT.match(stripped) and stripped.count("(") == stripped.count(")"):
            found.append(("statement deleted", ""))
        if begins and GUARD.match(stripped) and not codes[number].strip().startswith("else"):
            found.append(("statement deleted", ""))
        signature = "\n".join(codes[start - 1:number])
        if FUNCTION.match(signature):
            early = returned(signature)
            if early:
                found.append(("returns early", f"{line} {early}"))
        for kind, after in found:
            yield Mutation(file, number, kind, line, after)


def drawn(mutations, seed):
    """Yields mutations at random, one a line: lines with many are no more likely than others."""
    lines = {}
    for mutation in mutations:
        lines.setdefault((mutation.file, mutation.line), []).append(mutation)
    generator = random.Random(seed)
    order = sorted(lines)
    generator.shuffle(order)
    for place in order:
        yield generator.choice(lines[place])


# Of what a mistake leaves behind the compiler may warn, but the code is still code.
HARMLESS = ("unused-variable", "unused-parameter", "unused-function", "unused-but-set-variable",
            "unused-but-set-parameter", "unused-const-variable", "parentheses", "type-limits",
            "conversion", "sign-conversion", "float-conversion", "sign-compare", "unused-value",
            "bool-compare", "bool-operation", "empty-body", "misleading-indentation",
            "implicit-fallthrough", "unused-local-typedefs", "maybe-uninitialized")
TOLERANT = " ".join(f'_Pragma("GCC diagnostic warning \\"-W{name}\\"")' for name in HARMLESS)


def broken(text, mutation):
    """The text of the file with its mutation; warnings in the place of the copyright line."""
    lines = text.split("\n")
    if lines[mutation.line - 1] != mutation.before:
        raise ValueError(f"{mutation.file}:{mutation.line} is not `{mutation.before}`")
    lines[mutation.line - 1] = mutation.after
    if lines[0].startswith("//"):
        lines[0] = TOLERANT
    return "\n".join(lines)
