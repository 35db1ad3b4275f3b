"""Filters of experiments: arithmetic, comparisons and and/or/not over the fields of a point. Nothing else is evaluated:
no call, no index, no power, no attribute but the dots of a field's name."""
import ast
import operator

from .errors import SweepError, nearest

LONGEST = 1000
ARITHMETIC = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
COMPARISONS = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.In: lambda a, b: a in b,
    ast.NotIn: lambda a, b: a not in b,
}
CONSTANTS = {"true": True, "false": False}


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class Filter:
    """`text` compiled; `known` are the names that it may use. Throws SweepError."""

    def __init__(self, text, known):
        self.text = text
        if len(text) > LONGEST:
            raise SweepError(f"the filter has {len(text)} characters; at most {LONGEST} are taken")
        try:
            self.tree = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            raise SweepError(
                f"the filter '{text}' is no expression such as 'contents <= 64 and alus.flt.count < 4'"
            ) from error
        self.names = set()
        self.check(self.tree, set(known) | set(CONSTANTS))

    def check(self, node, known):
        """Refuses what is not of the few forms, before anything is evaluated."""
        name = self.name_of(node)
        if name is not None:
            if name not in known:
                raise SweepError(f"the filter has '{name}', which is no field of a point{nearest(name, known)}")
            self.names.add(name)
            return
        if isinstance(node, ast.Constant) and isinstance(node.value, (bool, int, float, str)):
            return
        forms = {
            ast.BoolOp: lambda: node.values,
            ast.UnaryOp: lambda: [node.operand] if isinstance(node.op, (ast.Not, ast.USub)) else None,
            ast.BinOp: lambda: [node.left, node.right] if type(node.op) in ARITHMETIC else None,
            ast.Compare: lambda: (
                [node.left, *node.comparators] if all(type(op) in COMPARISONS for op in node.ops) else None
            ),
            ast.Tuple: lambda: node.elts,
            ast.List: lambda: node.elts,
        }
        parts = forms.get(type(node), lambda: None)()
        if parts is None:
            raise SweepError(
                f"the filter has '{ast.unparse(node)}', which is not taken: it may use fields, numbers, words in "
                "quotes, + - * / // %, comparisons, in, and, or, not"
            )
        for part in parts:
            self.check(part, known)

    @staticmethod
    def name_of(node):
        """'alus.flt.count' of the attributes of attributes of a name; None of anything else."""
        parts = []
        while isinstance(node, ast.Attribute):
            parts.append(node.attr)
            node = node.value
        return ".".join([node.id, *reversed(parts)]) if isinstance(node, ast.Name) else None

    def passes(self, values):
        """Whether the point with these values of its fields is to be run."""
        try:
            result = self.value(self.tree, values)
        except (TypeError, ArithmeticError) as error:
            raise SweepError(f"the filter '{self.text}' cannot be computed: {error}") from error
        if not isinstance(result, bool):
            raise SweepError(f"the filter '{self.text}' gives {result!r}, which is neither true nor false")
        return result

    def value(self, node, values):
        name = self.name_of(node)
        if name is not None:
            return CONSTANTS[name] if name in CONSTANTS else values[name]
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, (ast.Tuple, ast.List)):
            return [self.value(each, values) for each in node.elts]
        if isinstance(node, ast.BoolOp):
            parts = (self.truth(each, values) for each in node.values)
            return all(parts) if isinstance(node.op, ast.And) else any(parts)
        if isinstance(node, ast.UnaryOp):
            negated = isinstance(node.op, ast.Not)
            return not self.truth(node.operand, values) if negated else -self.number(node.operand, values)
        if isinstance(node, ast.BinOp):
            return ARITHMETIC[type(node.op)](self.number(node.left, values), self.number(node.right, values))
        left = self.value(node.left, values)
        for comparison, part in zip(node.ops, node.comparators):
            right = self.value(part, values)
            if not COMPARISONS[type(comparison)](left, right):
                return False
            left = right
        return True

    def truth(self, node, values):
        value = self.value(node, values)
        if not isinstance(value, bool):
            raise TypeError(f"'{ast.unparse(node)}' is {value!r}, which is neither true nor false")
        return value

    def number(self, node, values):
        value = self.value(node, values)
        if not is_number(value):
            raise TypeError(f"'{ast.unparse(node)}' is {value!r}, which is not a number")
        return value
