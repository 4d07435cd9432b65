"""One child process per computation: its order, its limits, its work."""
