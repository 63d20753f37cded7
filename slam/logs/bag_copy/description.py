"""What ROS 2 says of a bag in metadata.yaml, with topics added to it."""

from collections.abc import Mapping, Sequence
from io import StringIO
from typing import Any

from ..message_types import MessageTypes

NAME = "metadata.yaml"


def described(text: str, added: Mapping[str, str], types: MessageTypes, counts: Sequence[Mapping[str, int]]) -> str:
    """Return a bag's description (YAML) with more topics in it; nothing else of it changes.

    Args:
        text: Of the bag as it was.
        added: Topics, and the type of each.
        types: Of messages.
        counts: Of each file of the bag, how many messages of each topic were added.
    """
    from ruamel.yaml import YAML

    yaml = YAML()
    content = yaml.load(text)
    bag = content.get("rosbag2_bagfile_information", content)
    topics = bag["topics_with_message_count"]
    older = topics[0]["topic_metadata"] if topics else {}
    for topic, kind in added.items():
        said: dict[str, Any] = {"name": topic, "type": kind, "serialization_format": "cdr"}
        said["offered_qos_profiles"] = "" if isinstance(older.get("offered_qos_profiles", ""), str) else []
        if "type_description_hash" in older:
            said["type_description_hash"] = types.definition(kind)[1]
        topics.append({"topic_metadata": said, "message_count": sum(count[topic] for count in counts)})
    bag["message_count"] += sum(sum(count.values()) for count in counts)
    for file, count in zip(bag.get("files") or (), counts, strict=False):
        file["message_count"] += sum(count.values())
    stream = StringIO()
    yaml.dump(content, stream)
    return stream.getvalue()
