"""Nothing that the program reads can run code: what could do so is nowhere in what runs.

Every source file of the package is looked at as a syntax tree, tests are not. What is allowed, and why:

- The pipes of `multiprocessing`, and of joblib's `Parallel`, pickle what they carry. Both ends are processes that this
  program has started, and no file or socket that somebody else could write to lies between; on a cluster (`--backend
  ray` or `dask`) it is the user's own, which runs the user's code by its nature. Files of joblib are not read.
- `tagalong evaluate my_module:Bold` imports a module of the user's own, who asks for it by name:
  `agents/protocol/user.py`. `scripts/site/named.py` imports modules of this package that the pages of `docs/` name,
  when the site is built. The other places that import by name, the doors of the floors among them, take it from a
  table in the program.
- The compiled kernels of numba (`cache=True`) lie in `__pycache__` beside the sources, or in `NUMBA_CACHE_DIR`, and
  numba's index of them is a pickle. They are a part of the installation: who can write there can change the program.
"""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("slam", "perception", "envs", "agents", "scripts")
SOURCES = sorted([*ROOT.glob("*.py"), *(path for room in ROOMS for path in (ROOT / room).rglob("*.py"))])

MODULES = {
    "pickle", "_pickle", "cPickle", "pickletools", "cloudpickle", "dill", "jsonpickle", "marshal", "shelve",
    "yaml", "runpy", "code", "codeop", "imp", "builtins",
}  # fmt: skip
BUILTINS = {"eval", "exec", "compile", "__import__"}
CALLS = {
    "torch.load", "torch.save", "torch.jit.load", "torch.hub.load", "os.system", "os.popen", "subprocess.getoutput",
    "subprocess.getstatusoutput", "numpy.lib.format.read_array", "joblib.load", "joblib.dump", "joblib.Memory",
}  # fmt: skip
STABLE_BASELINES = {"load", "save", "load_from_zip_file", "load_replay_buffer", "save_replay_buffer"}
IMPORTS_BY_NAME = {
    "agents/protocol/user.py", "slam/engine.py", "scripts/cli.py", "scripts/benchmarks/benchmark.py",
    "scripts/reproduce/experiment.py", "scripts/ros/node.py", "slam/door.py", "scripts/site/named.py",
}  # fmt: skip


def dotted(node):
    """The name of `a.b.c`, or ""."""
    parts = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
    return ".".join([node.id, *reversed(parts)]) if isinstance(node, ast.Name) else ""


def found_in_call(node, where):
    """What is wrong with a call."""
    name = dotted(node.func)
    last = name.rpartition(".")[2] or getattr(node.func, "attr", "")
    if name in CALLS or name.startswith(("os.exec", "os.spawn", "os.posix_spawn")):
        yield name
    of_numpy, of_something = name in ("np.load", "numpy.load"), isinstance(node.func, ast.Attribute)
    if where.startswith("agents/") and last in STABLE_BASELINES and of_something and not of_numpy:
        yield f"{last} of a model"
    if of_numpy and len(node.args) > 1:
        yield "np.load with more than a name"
    if last == "import_module" and where not in IMPORTS_BY_NAME:
        yield "import_module"
    for keyword in node.keywords:
        says = getattr(keyword.value, "value", "?")
        if (keyword.arg == "allow_pickle" and says is not False) or (keyword.arg == "shell" and says is not False):
            yield f"{keyword.arg}={says}"


def found(source, where):
    """Everything in a source text that could run code out of a file."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.partition(".")[0] in MODULES)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (name for name in names if name.partition(".")[0] in MODULES or name in CALLS)
        elif isinstance(node, ast.Name) and node.id in BUILTINS:
            yield node.id
        elif isinstance(node, ast.Call):
            yield from found_in_call(node, where)
        for word in (getattr(node, "attr", ""), getattr(node, "id", "")):
            if "pickle" in word.lower():
                yield word


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_nothing_in_the_package_runs_code_that_it_reads(path):
    assert list(found(path.read_text(encoding="utf-8"), path.relative_to(ROOT).as_posix())) == []


@pytest.mark.parametrize(
    "source",
    [
        "import pickle", "from pickle import loads", "import dill as d", "joblib.load(f)", "from joblib import load",
        "import yaml",
        "from multiprocessing.reduction import x; x.ForkingPickler", "eval('1')", "list(map(exec, ['1']))",
        "compile('1', '', 'eval')", "__import__('os')", "torch.load('m')", "from torch import load",
        "np.load(f, allow_pickle=True)", "np.load(f, allow_pickle=maybe)", "np.load(f, None, True)",
        "os.system('ls')", "from os import system", "os.execv('ls', [])", "subprocess.run('ls', shell=True)",
        "PPO.load('m.zip')", "model.save('m.zip')", "CLASSES[algo].load('m.zip')", "import_module(name)",
        "pandas.read_pickle('x')", "importlib.import_module(name)",
    ],
)  # fmt: skip
def test_what_could_run_code_is_found(source):
    assert list(found(source, "agents/training/some.py"))


@pytest.mark.parametrize(
    "source",
    ["re.compile('a')", "model.eval()", "np.load(f, allow_pickle=False)", "json.loads('1')", "def evaluate(): ..."],
)
def test_what_could_not_is_left_alone(source):
    assert not list(found(source, "agents/training/some.py"))
