"""What `pip install .` calls (PEP 517): CMake builds and installs the package, and the files are packed as a wheel.

build_backend.py BUILD FOLDER packs what a build has built already."""

import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile
from pathlib import Path

root = Path(__file__).resolve().parent.parent


def project() -> tuple[dict, str]:
    """Its table of pyproject.toml, and the version, which CMakeLists.txt has."""
    version = re.search(r"^project\(rosin VERSION (\S+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
    return tomllib.loads((root / "pyproject.toml").read_text())["project"], version


def metadata() -> str:
    about, version = project()
    lines = ["Metadata-Version: 2.1", f"Name: {about['name']}", f"Version: {version}",
             f"Summary: {about['description']}", f"License: {about['license']['text']}",
             f"Requires-Python: {about['requires-python']}"]
    lines += [f"Requires-Dist: {needed}" for needed in about["dependencies"]]
    for extra, packages in about["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}", *(f"Requires-Dist: {one}; extra == '{extra}'" for one in packages)]
    lines += ["Description-Content-Type: text/markdown", "", (root / about["readme"]).read_text()]
    return "\n".join(lines)


def jobs() -> int:
    """A compiling file needs up to 0.9 GB."""
    gigabytes = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9
    return max(1, min(os.cpu_count() or 1, int(gigabytes)))


def install(build: Path, prefix: Path) -> None:
    subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", prefix, "--strip"], check=True)


def pack(installed: Path, wheel_directory: Path) -> str:
    """Makes a wheel of all files below a folder; its name."""
    about, version = project()
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{tag}-{tag}-{re.sub('[-.]', '_', sysconfig.get_platform())}"
    info = f"{about['name']}-{version}.dist-info"
    contents = {str(file.relative_to(installed)): file.read_bytes() for file in installed.rglob("*") if file.is_file()}
    contents[f"{info}/METADATA"] = metadata().encode()
    contents[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: rosin\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    name = f"{about['name']}-{version}-{tag}.whl"
    with zipfile.ZipFile(wheel_directory / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        record = ""
        for path, content in contents.items():
            wheel.writestr(path, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(content)}\n"
        wheel.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return name


def wheel_of(build: Path, wheel_directory: Path) -> str:
    with tempfile.TemporaryDirectory() as installed:
        install(build, Path(installed))
        return pack(Path(installed), wheel_directory)


def make(build: Path, target: str) -> None:
    parallel = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(jobs()))
    subprocess.run(["cmake", "--build", build, "--target", target, "--parallel", parallel], check=True)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The libraries are those of the build in ROSIN_DIR, or that of the quick start, brought up to date, or new ones."""
    build = root / "build/python"
    built = Path(os.environ.get("ROSIN_DIR", root / "build/release")).absolute()
    if (built / "rosinBuild.cmake").exists():
        make(built, "rosin_app")
    elif "ROSIN_DIR" in os.environ:
        raise SystemExit(f"ROSIN_DIR = {built} is no build of rosin: it has no rosinBuild.cmake")
    else:
        built = ""
    subprocess.run(["cmake", "--preset", "release", "-S", root, "-B", build, "-DROSIN_PYTHON_PACKAGE=ON", f"-DROSIN_DIR={built}",
                    "-DROSIN_TESTS=OFF", f"-DPython_EXECUTABLE={sys.executable}"], check=True, cwd=root)
    make(build, "rosin_module")
    return wheel_of(build, Path(wheel_directory))


def build_sdist(sdist_directory, config_settings=None):
    about, version = project()
    name = f"{about['name']}-{version}"
    target = Path(sdist_directory) / f"{name}.tar.gz"
    subprocess.run(["git", "archive", f"--prefix={name}/", "-o", target, "HEAD"], check=True, cwd=root)
    return target.name


if __name__ == "__main__":
    print(wheel_of(Path(sys.argv[1]), Path(sys.argv[2])))
