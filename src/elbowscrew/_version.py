"""The version, where the build finds it without importing anything."""

__version__ = "0.2.0.dev0"
