"""What a file does not state is asked for in one question."""

from __future__ import annotations

from pathlib import Path

import pytest

from elbowscrew import read_recording
from elbowscrew.errors import SettingError


def test_unit_and_order_of_angles_are_asked_for_together(real_data: Path) -> None:
    case = real_data / "cases" / "units_missing_info.csv"
    with pytest.raises(SettingError, match=r"units m, cm or mm, and rotation XYZ"):
        read_recording(case)
    with pytest.raises(SettingError, match="Euler angles; give rotation XYZ") as asked:
        read_recording(case, units="cm")
    assert "units" not in str(asked.value).removeprefix(str(case))
    with pytest.raises(SettingError, match="unit of length; give units") as asked:
        read_recording(case, rotation="XYZ")
    assert "rotation" not in str(asked.value)
    assert read_recording(case, units="cm", rotation="XYZ").frame.size == 3
